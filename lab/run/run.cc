#include "lab/run/run.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cmath>
#include <filesystem>
#include <lab/type_t.hpp>
#include <random>
#include <set>

#include "core/util/console.h"
#include "lab/experiment/experiment_yaml.h"
#include "lcmtypes/texts.h"
#include "wire/log/checked_log.h"
#include "wire/log/log_writer.h"
#include "wire/process/participant.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab {

run_t make_run(const Experiment& experiment, const Robot& robot) {
  run_t run{};
  run.step = kBeforeStart;
  run.experiment = canonical(experiment);
  run.urdf = robot.urdf;
  run.model_hash = robot.hash;
  run.seed = experiment.seed;
  run.nq = robot.model.nq;
  run.nv = robot.model.nv;
  for (int joint = 1; joint < static_cast<int>(robot.model.njoints); ++joint)
    if (robot.model.joints[joint].nv() > 0) run.joint_names.push_back(robot.model.names[joint]);
  run.njoints = static_cast<int32_t>(run.joint_names.size());
  const int64_t parts[3] = {static_cast<int64_t>(XXH3_64bits(run.experiment.data(), run.experiment.size())),
                            run.model_hash, run.seed};
  run.run = static_cast<int64_t>(XXH3_64bits(parts, sizeof parts));
  if (experiment.simulator.clock == "realtime")
    run.run = std::llround(1e3 * std::random_device()()) ^ wall_now();
  if (run.run == 0) run.run = 1;
  return run;
}

RunView open_run(const run_t& run) {
  RunView view;
  view.experiment = parse_experiment(run.experiment, "RUN");
  view.robot = run.urdf.empty() ? load_robot(view.experiment) : load_robot(view.experiment, run.urdf);
  return view;
}

RunSetup setup_of(const RunView& run) {
  const Experiment& e = run.experiment;
  return {run.robot.hash,
          static_cast<int>(run.robot.model.nq),
          static_cast<int>(run.robot.model.nv),
          e.simulator.dt,
          e.last_step(),
          e.planner.lead,
          e.controller.every,
          e.simulator.clock == "realtime",
          static_cast<int64_t>(std::floor(e.safety.timeout / e.simulator.dt + 1e-9))};
}

namespace {

std::vector<Bytes> encode_types(int64_t run, const std::set<std::string>& names) {
  const Schema& schema = lab_schema();
  std::vector<Bytes> messages;
  for (const std::string& name : names) {
    const Type& type = *schema.find(name);
    type_t message{};
    message.run = run;
    message.step = kBeforeStart;
    message.name = name;
    message.fingerprint = type.fingerprint;
    message.source = schema.sources()[type.source].text;
    std::set<std::string> channels;
    for (const ChannelRow& channel : kChannelTable)
      if (channel.type == name) channels.emplace(channel.name);
    message.channels.assign(channels.begin(), channels.end());
    message.nchannels = static_cast<int32_t>(channels.size());
    messages.push_back(encode(message));
  }
  return messages;
}

}  // namespace

std::vector<Bytes> type_messages(int64_t run) {
  const Schema& schema = lab_schema();
  std::set<std::string> names;
  for (const ChannelRow& channel : kChannelTable)
    if (channel.log_file == LogFile::Log) names.emplace(channel.type);
  for (bool grown = true; grown;) {  // and the types inside them
    grown = false;
    for (const std::string& name : std::set<std::string>(names))
      for (const Field& field : schema.find(name)->fields)
        if (field.kind == Kind::Struct) grown |= names.insert(field.type_name).second;
  }
  return encode_types(run, names);
}

std::vector<Bytes> all_type_messages(int64_t run) {
  std::set<std::string> names;
  for (const Type& type : lab_schema().types()) names.insert(type.name);
  return encode_types(run, names);
}

ReadLog log_reader(const std::string& log_path) {
  return [log_path](int64_t run, const std::function<void(Channel, std::span<const uint8_t>)>& visit) {
    const std::string path = std::filesystem::exists(part_name(log_path)) ? part_name(log_path) : log_path;
    if (!std::filesystem::exists(path)) return;
    const LogFindings found = read_checked(path, [&](Channel channel, std::span<const uint8_t> message) {
      if (peek_run(message) == run) visit(channel, message);
    });
    for (const LogDamage& damage : found.damages) say("{}: damaged: {}", path, text_of(damage));
  };
}

}  // namespace lab
