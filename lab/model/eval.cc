#include "lab/model/eval.h"

#include <fmt/format.h>
#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "core/util/json_text.h"
#include "lab/model/describe.h"

namespace lab::model {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// ---- input

struct State {
  Eigen::VectorXd q, v, a, tau;
};

/// A piece of input as a person would look for it: short, on one line.
std::string seen(const json& value) {
  const std::string text = json_text(value);
  return text.size() > 40 ? text.substr(0, 37) + ".." : text;
}

/// `n` numbers under `key`; zeros where `required` is false and the key is missing. Throws
/// std::invalid_argument.
Eigen::VectorXd numbers(const json& state, const char* key, int n, bool required) {
  const auto found = state.find(key);
  if (found == state.end()) {
    if (required) throw std::invalid_argument(fmt::format("{} is missing, expected {} numbers", key, n));
    return Eigen::VectorXd::Zero(n);
  }
  if (!found->is_array())
    throw std::invalid_argument(fmt::format("{} is {}, expected a list of {} numbers", key, seen(*found), n));
  if (found->size() != static_cast<size_t>(n))
    throw std::invalid_argument(fmt::format("{} has {} numbers, expected {}", key, found->size(), n));
  Eigen::VectorXd out(n);
  for (int k = 0; k < n; ++k) {
    const json& entry = (*found)[static_cast<size_t>(k)];
    if (!entry.is_number())
      throw std::invalid_argument(fmt::format("{}[{}] is {}, not a number", key, k, seen(entry)));
    out[k] = entry.get<double>();
  }
  return out;
}

State state_of(const rbd::Model& model, const json& in) {
  if (!in.is_object())
    throw std::invalid_argument(fmt::format("is {}, expected an object with q, v, a, tau", seen(in)));
  return {numbers(in, "q", model.nq, true), numbers(in, "v", model.nv, false),
          numbers(in, "a", model.nv, false), numbers(in, "tau", model.nv, false)};
}

std::vector<rbd::FrameIndex> frames_of(const rbd::Model& model, const json& in) {
  std::vector<rbd::FrameIndex> out;
  const auto found = in.find("frames");
  if (found == in.end()) return out;
  if (!found->is_array())
    throw InputError(fmt::format("frames is {}, expected a list of names", seen(*found)));
  for (const json& name : *found) {
    if (!name.is_string()) throw InputError(fmt::format("frames has {}, expected names", seen(name)));
    try {
      out.push_back(model.frameId(name.get<std::string>()));
    } catch (const std::out_of_range& error) {
      throw InputError(error.what());
    }
  }
  return out;
}

void note_unread(const json& object, const std::string& where, const std::vector<std::string>& known,
                 std::vector<std::string>& warnings) {
  for (const auto& item : object.items()) {
    if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
    warnings.push_back(fmt::format("{}'{}' is not read ({} are)", where, item.key(), fmt::join(known, ", ")));
  }
}

// ---- output

template <class Vector>
ordered_json list(const Vector& x) {
  ordered_json out = ordered_json::array();
  for (Eigen::Index k = 0; k < x.size(); ++k) out.push_back(double{x[k]});
  return out;
}

template <class Matrix>
ordered_json rows(const Matrix& m) {
  ordered_json out = ordered_json::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) out.push_back(list(m.row(r)));
  return out;
}

/// Where the first number stands that is NaN or infinite: "M[0][1]"; "" if there is none.
std::string not_finite(const ordered_json& value, const std::string& where) {
  if (value.is_number_float()) return std::isfinite(value.get<double>()) ? "" : where;
  if (!value.is_structured()) return "";
  for (const auto& item : value.items()) {
    const std::string inside = value.is_array() ? where + "[" + item.key() + "]"
                               : where.empty()  ? item.key()
                                                : where + "." + item.key();
    if (std::string bad = not_finite(item.value(), inside); !bad.empty()) return bad;
  }
  return "";
}

void require_finite(const ordered_json& out) {
  if (const std::string bad = not_finite(out, ""); !bad.empty())
    throw std::runtime_error(bad + " is too large for a number: look at the size of q, v, a and tau");
}

constexpr std::pair<const char*, rbd::ReferenceFrame> kReferences[] = {
    {"WORLD", rbd::WORLD}, {"LOCAL", rbd::LOCAL}, {"LOCAL_WORLD_ALIGNED", rbd::LOCAL_WORLD_ALIGNED}};

/// Needs forwardKinematics with v and a, and computeJointJacobians.
ordered_json frame_json(const rbd::Model& model, const rbd::Data& data, rbd::FrameIndex frame) {
  ordered_json J, velocity, acceleration, classical;
  for (const auto& [name, reference] : kReferences) {
    J[name] = rows(rbd::getFrameJacobian(model, data, frame, reference));
    velocity[name] = list(rbd::getFrameVelocity(model, data, frame, reference).toVector());
    acceleration[name] = list(rbd::getFrameAcceleration(model, data, frame, reference).toVector());
    classical[name] = list(rbd::getFrameClassicalAcceleration(model, data, frame, reference).toVector());
  }
  return {{"J", J},
          {"velocity", velocity},
          {"acceleration", acceleration},
          {"classical_acceleration", classical}};
}

ordered_json state_json(const rbd::Model& model, rbd::Data& data, const State& s,
                        const std::vector<rbd::FrameIndex>& frames) {
  ordered_json out, oMi, oMf;
  rbd::forwardKinematics(model, data, s.q, s.v, s.a);
  for (int j = 0; j < model.njoints; ++j) oMi[model.names[j]] = rows(data.oMi[j].toHomogeneousMatrix());
  // a name that two frames share stands for the first one, as for frameId
  for (int f = 0; f < model.nframes; ++f)
    if (!oMf.contains(model.frames[f].name))
      oMf[model.frames[f].name] = rows(data.oMf[f].toHomogeneousMatrix());
  out["oMi"] = std::move(oMi);
  out["oMf"] = std::move(oMf);

  out["M"] = rows(rbd::crba(model, data, s.q));
  out["Minv"] = rows(rbd::computeMinverse(model, data, s.q));
  out["C"] = rows(rbd::computeCoriolisMatrix(model, data, s.q, s.v));
  out["nle"] = list(rbd::nonLinearEffects(model, data, s.q, s.v));
  out["g"] = list(rbd::computeGeneralizedGravity(model, data, s.q));
  out["tau"] = list(rbd::rnea(model, data, s.q, s.v, s.a));
  out["ddq"] = list(rbd::aba(model, data, s.q, s.v, s.tau));

  out["com"] = list(rbd::centerOfMass(model, data, s.q, s.v));
  out["vcom"] = list(data.vcom[0]);
  out["Jcom"] = rows(rbd::jacobianCenterOfMass(model, data, s.q));
  rbd::computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, s.a);
  out["hg"] = list(data.hg.toVector());
  out["Ag"] = rows(rbd::computeCentroidalMap(model, data, s.q));
  out["dhg"] = list(data.dhg.toVector());
  out["kinetic"] = rbd::computeKineticEnergy(model, data, s.q, s.v);
  out["potential"] = rbd::computePotentialEnergy(model, data, s.q);

  rbd::forwardKinematics(model, data, s.q, s.v, s.a);
  rbd::computeJointJacobians(model, data, s.q);
  ordered_json named = ordered_json::object();
  for (rbd::FrameIndex frame : frames) named[model.frames[frame].name] = frame_json(model, data, frame);
  out["frames"] = std::move(named);

  require_finite(out);  // before the derivatives, which start from these numbers
  rbd::computeRNEADerivatives(model, data, s.q, s.v, s.a);
  out["dtau_dq"] = rows(data.dtau_dq);
  out["dtau_dv"] = rows(data.dtau_dv);
  rbd::computeABADerivatives(model, data, s.q, s.v, s.tau);
  out["ddq_dq"] = rows(data.ddq_dq);
  out["ddq_dv"] = rows(data.ddq_dv);

  require_finite(out);
  return out;
}

}  // namespace

json parse(const std::string& text) {
  try {
    return parse_json(text);
  } catch (const json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: ..": the bracket is the library's
    // own
    const std::string what = error.what();
    const size_t end = what.find("] ");
    throw InputError("the input is not JSON: " + (end == what.npos ? what : what.substr(end + 2)));
  }
}

Evaluation evaluate(const rbd::Model& model, const json& in) {
  Evaluation result;
  if (!in.is_object())
    throw InputError(fmt::format("the input is {}, expected an object with states and frames", seen(in)));
  note_unread(in, "", {"states", "frames"}, result.warnings);
  const std::vector<rbd::FrameIndex> frames = frames_of(model, in);

  ordered_json joints = ordered_json::array();
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() > 0) joints.push_back(model.names[j]);
  result.out = {{"nq", model.nq}, {"nv", model.nv}, {"mass", mass_of(model)}, {"joints", joints}};

  const auto states = in.find("states");
  if (states == in.end()) return result;
  if (!states->is_array()) throw InputError(fmt::format("states is {}, expected a list", seen(*states)));
  rbd::Data data(model);
  ordered_json& out = result.out["states"] = ordered_json::array();
  for (size_t k = 0; k < states->size(); ++k) {
    const json& state = (*states)[k];
    const std::string where = fmt::format("state {}: ", k);
    if (state.is_object()) note_unread(state, where, {"q", "v", "a", "tau"}, result.warnings);
    try {
      out.push_back(state_json(model, data, state_of(model, state), frames));
    } catch (const std::exception& error) {
      out.push_back({{"error", error.what()}});
      result.errors.push_back(where + error.what());
    }
  }
  return result;
}

}  // namespace lab::model
