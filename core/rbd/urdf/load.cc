// A URDF file from text to Model and GeometryModel, stage by stage.
#include <tinyxml2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "rbd/urdf/build.h"
#include "rbd/urdf/check_inertia.h"
#include "rbd/urdf/check_tree.h"
#include "rbd/urdf/read_elements.h"
#include "rbd/urdf/shapes.h"
#include "rbd/urdf/urdf.h"

namespace rbd::urdf {
namespace {

GeometryModel place_shapes(std::vector<LinkShape> shapes, const Model& model) {
  GeometryModel out;
  for (LinkShape& item : shapes) {
    const FrameIndex link = model.getFrameId(item.link, BODY);
    item.object.parentFrame = link;
    item.object.parentJoint = model.frames[link].parentJoint;
    item.object.placement = model.frames[link].placement * item.object.placement;
    (item.visual ? out.visual : out.collision).push_back(std::move(item.object));
  }
  return out;
}

// From text to Loaded, in stages: a stage runs only when the previous ones found no error, so that one
// mistake gives one message.
void load_checked(const std::string& text, const Options& options, Loaded& out, Report& report) {
  // XML: well-formed, one <robot>, known elements
  tinyxml2::XMLDocument document;
  const tinyxml2::XMLElement* xml = parse_robot(text, document, report);
  if (!xml) return;
  check_vocabulary(*xml, report);
  if (report.failed()) return;

  // each link, joint and shape on its own
  const Description robot = read_elements(*xml, report);
  std::vector<LinkShape> shapes = read_shapes(*xml, report);
  if (report.failed()) return;

  // checks across links and joints
  const std::string root = check_tree(robot, report);
  check_names(robot, options.floating_base, report);
  if (report.failed()) return;
  check_mimic(robot, options.mimic, report);
  if (report.failed()) return;

  // the model, and whether its inertias are physically possible
  build(robot, root, options, out.model);
  check_inertia(out.model, robot, report);
  if (report.failed()) return;
  if (options.meshes) find_meshes(shapes, options.package_dirs, report);
  out.geometry = place_shapes(std::move(shapes), out.model);
}

Loaded refused(const std::string& file, const std::string& message) {
  Loaded out;
  out.diagnostics.push_back({Severity::Error, file, 0, "", message});
  return out;
}

std::vector<Diagnostic> finish(Loaded loaded, Model& model) {
  if (!loaded.ok()) throw Error(std::move(loaded.diagnostics));
  model = std::move(loaded.model);
  return std::move(loaded.diagnostics);
}

Options without_meshes(Options options) {
  options.meshes = false;
  return options;
}

Options floating() {
  Options options;
  options.floating_base = true;
  return without_meshes(options);
}

}  // namespace

bool Loaded::ok() const {
  return std::none_of(diagnostics.begin(), diagnostics.end(),
                      [](const Diagnostic& d) { return d.severity == Severity::Error; });
}

Loaded loadXML(const std::string& text, const Options& options, const std::string& name) {
  Loaded out;
  Report report(name);
  try {
    load_checked(text, options, out, report);
  } catch (const std::exception& e) {  // thrown by the core: the stages above lack a check for it
    report.error(0, "", e.what());
  }
  if (options.strict) report.refuse_warnings();
  if (report.failed()) out = Loaded();
  out.diagnostics = report.take();
  return out;
}

Loaded load(const std::string& file, const Options& options) {
  std::error_code none;
  if (std::filesystem::is_directory(file, none)) return refused(file, "is a folder, not a URDF file");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) return refused(file, std::string("cannot be read (") + std::strerror(errno) + ")");
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (in.bad()) return refused(file, "cannot be read to its end");
  return loadXML(text, options, file);
}

std::vector<Diagnostic> buildModel(const std::string& file, Model& model, const Options& options) {
  return finish(load(file, without_meshes(options)), model);
}

std::vector<Diagnostic> buildModelFromXML(const std::string& text, Model& model, const Options& options) {
  return finish(loadXML(text, without_meshes(options)), model);
}

std::vector<Diagnostic> buildModel(const std::string& file, const JointModelFreeFlyer&, Model& model) {
  return finish(load(file, floating()), model);
}

std::vector<Diagnostic> buildModelFromXML(const std::string& text, const JointModelFreeFlyer&, Model& model) {
  return finish(loadXML(text, floating()), model);
}

std::vector<Diagnostic> buildModelsFromUrdf(const std::string& file,
                                            const std::vector<std::string>& package_dirs, Model& model,
                                            GeometryModel& geometry, Options options) {
  options.package_dirs.insert(options.package_dirs.begin(), package_dirs.begin(), package_dirs.end());
  Loaded loaded = load(file, options);
  if (loaded.ok()) geometry = std::move(loaded.geometry);
  return finish(std::move(loaded), model);
}

}  // namespace rbd::urdf
