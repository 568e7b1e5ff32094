// From a checked tree of links and joints to a Model.
#include <tinyxml2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>

#include "rbd/urdf/bodies.h"
#include "rbd/urdf/dom.h"
#include "rbd/urdf/shapes.h"
#include "rbd/urdf/urdf.h"

namespace rbd::urdf {
namespace {

using Tree = ::urdf::ModelInterface;
using JointPtr = ::urdf::JointSharedPtr;

Eigen::Vector3d vector_of(const ::urdf::Vector3& v) { return {v.x, v.y, v.z}; }

SE3 pose_of(const ::urdf::Pose& pose) {
  const ::urdf::Rotation& r = pose.rotation;
  return SE3(Eigen::Quaterniond(r.w, r.x, r.y, r.z), vector_of(pose.position));
}

Inertia inertia_of(const ::urdf::Inertial& body) {
  Eigen::Matrix3d i;
  i << body.ixx, body.ixy, body.ixz, body.ixy, body.iyy, body.iyz, body.ixz, body.iyz, body.izz;
  const SE3 pose = pose_of(body.origin);  // where the inertia's own axes stand in the link
  return pose.act(Inertia(body.mass, Eigen::Vector3d::Zero(), i));
}

// What a file writes for "no limit" would overflow where limits are subtracted.
double limit_of(double value) {
  return std::abs(value) < 1e100 ? value : std::copysign(std::numeric_limits<double>::infinity(), value);
}

// Builds the tree below the root link; brothers alphabetical, depth first, without recursion.
class Builder {
 public:
  Builder(const Tree& tree, const Options& options, Model& model) : tree_(tree), model_(model) {
    const bool floating_base = options.floating_base;
    model_.name = tree.getName();
    JointIndex root = 0;
    if (floating_base) root = model_.addJoint(0, JointModelFreeFlyer(), SE3::Identity(), "root_joint");
    add_link(*tree.getRoot(), root, SE3::Identity(), floating_base ? last_frame() : 0);
    while (!open_.empty()) {
      const JointPtr joint = open_.back();
      open_.pop_back();
      add_joint(*joint);
    }
    if (options.mimic) follow_leaders();
  }

 private:
  FrameIndex last_frame() const { return model_.nframes - 1; }

  void add_joint(const ::urdf::Joint& joint) {
    const FrameIndex above = model_.getFrameId(joint.parent_link_name, BODY);
    const JointIndex carrier = model_.frames[above].parentJoint;
    const SE3 placement = model_.frames[above].placement * pose_of(joint.parent_to_joint_origin_transform);
    const ::urdf::Link& child = *tree_.getLink(joint.child_link_name);
    if (joint.type == ::urdf::Joint::FIXED) {
      model_.addFrame(Frame(joint.name, carrier, above, placement, FIXED_JOINT));
      add_link(child, carrier, placement, last_frame());
    } else {
      const JointIndex index = add_moving(joint, carrier, above, placement);
      add_link(child, index, SE3::Identity(), last_frame());
    }
  }

  JointIndex add_moving(const ::urdf::Joint& joint, JointIndex carrier, FrameIndex above,
                        const SE3& placement) {
    const JointModel kind = kind_of(joint);
    JointLimits limits;
    if (joint.limits) {
      // one number for all dofs of a joint, as for one
      const auto all = [&](double x) { return Eigen::VectorXd::Constant(kind.kind_nv(), limit_of(x)); };
      limits.lowerEffort = all(-joint.limits->effort);
      limits.upperEffort = all(joint.limits->effort);
      limits.lowerVelocity = all(-joint.limits->velocity);
      limits.upperVelocity = all(joint.limits->velocity);
      if (joint.type == ::urdf::Joint::REVOLUTE || joint.type == ::urdf::Joint::PRISMATIC) {
        limits.lowerPosition = all(joint.limits->lower);
        limits.upperPosition = all(joint.limits->upper);
      }
    }
    const JointIndex index = model_.addJoint(carrier, kind, placement, joint.name, limits, above);
    if (joint.dynamics) {
      const int v = model_.joints[index].idx_v(), nv = kind.kind_nv();
      model_.damping.segment(v, nv).setConstant(joint.dynamics->damping);
      model_.friction.segment(v, nv).setConstant(joint.dynamics->friction);
    }
    return index;
  }

  // Leaders may stand anywhere, so this waits until all joints are there.
  void follow_leaders() {
    for (JointIndex j = 1; j < model_.njoints; ++j) {
      const ::urdf::JointConstSharedPtr joint = tree_.getJoint(model_.names[j]);
      if (!joint || !joint->mimic) continue;
      model_.setMimic(j, model_.jointId(joint->mimic->joint_name), joint->mimic->multiplier,
                      joint->mimic->offset);
    }
  }

  static JointModel kind_of(const ::urdf::Joint& joint) {
    const Eigen::Vector3d axis = vector_of(joint.axis);
    if (joint.type == ::urdf::Joint::FLOATING) return JointModelFreeFlyer();
    if (joint.type == ::urdf::Joint::PLANAR) return JointModelPlanar(axis);
    if (joint.type == ::urdf::Joint::PRISMATIC) return JointModelPrismaticUnaligned(axis);
    if (joint.type == ::urdf::Joint::CONTINUOUS) return JointModelContinuous(axis);
    return JointModelRevoluteUnaligned(axis);
  }

  void add_link(const ::urdf::Link& link, JointIndex carrier, const SE3& placement, FrameIndex above) {
    const Inertia inertia = link.inertial ? inertia_of(*link.inertial) : Inertia::Zero();
    model_.addBodyFrame(link.name, carrier, placement, above, inertia);

    std::vector<JointPtr> below = link.child_joints;
    std::sort(below.begin(), below.end(),
              [](const JointPtr& a, const JointPtr& b) { return a->name > b->name; });
    open_.insert(open_.end(), below.begin(), below.end());
  }

  const Tree& tree_;
  Model& model_;
  std::vector<JointPtr> open_;  // joints still to be added, the next one last
};

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

// Everything between text and Loaded, in stages: a stage runs only when those before found no error, so that
// one mistake gives one message.
void load_checked(const std::string& text, const Options& options, Loaded& out, Report& report) {
  tinyxml2::XMLDocument document;
  tinyxml2::XMLElement* robot = parse_robot(text, document, report);
  if (!robot) return;
  check_vocabulary(*robot, report);
  if (report.failed()) return;
  const Elements elements = check_elements(*robot, report);
  std::vector<LinkShape> shapes = read_shapes(*robot, report);
  if (report.failed()) return;
  check_tree(elements, report);
  check_names(elements, options.floating_base, report);
  if (report.failed()) return;
  check_mimic(elements, options.mimic, report);
  if (report.failed()) return;

  const ::urdf::ModelInterfaceSharedPtr tree = read_dom(*robot, elements, report);
  if (!tree) return;
  const Builder builder(*tree, options, out.model);
  check_bodies(out.model, elements, report);
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
  } catch (const std::exception& e) {  // of the core: the checks above should have been first
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
