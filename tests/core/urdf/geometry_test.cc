// Shapes, colours, and where meshes are found.
#include <gtest/gtest.h>
#include <rbd/urdf/shapes.h>
#include <rbd/urdf/urdf.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/support/paths.h"

namespace rbd::urdf {
namespace {

namespace fs = std::filesystem;

std::string visual(const std::string& geometry, const std::string& more = "") {
  return "<visual><geometry>" + geometry + "</geometry>" + more + "</visual>";
}
Loaded robot(const std::string& inside, const std::string& name = "<urdf>", const Options& options = {}) {
  return loadXML("<robot name='r'>\n" + inside + "</robot>", options, name);
}

TEST(UrdfGeometry, SampleArm) {
  Model model;
  GeometryModel shapes;
  EXPECT_TRUE(
      buildModelsFromUrdf(lab::source_path("models/simple_3dof_arm.urdf"), {}, model, shapes).empty());
  ASSERT_EQ(shapes.visual.size(), 4u);
  ASSERT_EQ(shapes.collision.size(), 4u);
  const auto is = [&](int k, const std::string& link, JointIndex joint, Shape shape,
                      const Eigen::Vector3d& size, double height) {
    const GeometryObject& o = shapes.visual[k];
    EXPECT_EQ(o.name, link + "_0");
    EXPECT_EQ(model.frames[o.parentFrame].name, link);
    EXPECT_EQ(o.parentJoint, joint);
    EXPECT_EQ(o.shape, shape);
    EXPECT_EQ(o.size, size);
    EXPECT_TRUE(o.placement.isApprox(SE3(Eigen::Matrix3d::Identity(), {0, 0, height}), 0));
    EXPECT_TRUE(o.hasColor);
    EXPECT_EQ(shapes.collision[k].size, size);
    EXPECT_FALSE(shapes.collision[k].hasColor);
  };
  is(0, "base_link", 0, Shape::Box, {0.2, 0.2, 0.1}, 0);
  is(1, "link1", 1, Shape::Cylinder, {0.05, 0.5, 0}, 0.25);
  is(2, "link2", 2, Shape::Cylinder, {0.04, 0.4, 0}, 0.2);
  is(3, "end_effector", 3, Shape::Sphere, {0.03, 0, 0}, 0);
  EXPECT_EQ(shapes.visual[3].rgba, Eigen::Vector4d(0.82, 0.16, 0.18, 1));
}

// A shape on a link that is welded to a moving one: poses multiply.
TEST(UrdfGeometry, PlacementIsInTheMovingJoint) {
  const std::string text =
      "<link name='a'/><link name='b'/><link name='c'><visual><origin xyz='1 2 3' rpy='0.1 0.2 0.3'/>"
      "<geometry><capsule radius='0.1' length='0.4'/></geometry></visual></link>"
      "<joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis xyz='0 0 1'/></joint>"
      "<joint name='f' type='fixed'><parent link='b'/><child link='c'/><origin xyz='0 0 5' rpy='0 0 "
      "1.5'/></joint>";
  const Loaded loaded = robot(text);
  ASSERT_TRUE(loaded.ok());
  ASSERT_EQ(loaded.geometry.visual.size(), 1u);
  const GeometryObject& o = loaded.geometry.visual[0];
  EXPECT_EQ(o.parentJoint, 1);
  EXPECT_EQ(o.shape, Shape::Capsule);
  EXPECT_EQ(o.size, Eigen::Vector3d(0.1, 0.4, 0));
  const auto about = [](double angle, int axis) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis));
  };
  const SE3 wanted(Eigen::Matrix3d(about(1.5, 2) * about(0.3, 2) * about(0.2, 1) * about(0.1, 0)),
                   Eigen::Vector3d(0, 0, 5) + about(1.5, 2) * Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(o.placement.isApprox(wanted, 1e-14));
}

TEST(UrdfGeometry, ColoursByNameAndByPlace) {
  const std::string ball = "<sphere radius='1'/>";
  const Loaded loaded = robot(
      "<material name='red'><color rgba='1 0 0 1'/></material>"
      "<link name='a'>" +
      visual(ball, "<material name='red'/>") +                                      // of the file
      visual(ball, "<material name='late'/>") +                                     // given further down
      visual(ball, "<material name='late'><color rgba='0 0 1 0.5'/></material>") +  // here
      visual(ball, "<material name='red'><color rgba='0 1 0 1'/></material>") +     // its own wins
      visual(ball, "<material name=''><color rgba='0 1 1 1'/></material>") + visual(ball) +  // nameless; none
      "</link>");
  ASSERT_TRUE(loaded.ok());
  EXPECT_TRUE(loaded.diagnostics.empty());
  const auto& v = loaded.geometry.visual;
  ASSERT_EQ(v.size(), 6u);
  EXPECT_EQ(v[0].rgba, Eigen::Vector4d(1, 0, 0, 1));
  EXPECT_EQ(v[1].rgba, Eigen::Vector4d(0, 0, 1, 0.5));
  EXPECT_EQ(v[2].rgba, Eigen::Vector4d(0, 0, 1, 0.5));
  EXPECT_EQ(v[3].rgba, Eigen::Vector4d(0, 1, 0, 1));
  EXPECT_EQ(v[4].rgba, Eigen::Vector4d(0, 1, 1, 1));
  EXPECT_FALSE(v[5].hasColor);
  EXPECT_EQ(v[5].name, "a_5");
}

// A folder of its own with empty mesh files; environment as the test sets it.
class MeshLookup : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "urdf_mesh_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    root_ = fs::canonical(pattern);
    for (const char* name : kVariables) unsetenv(name);
  }
  void TearDown() override {
    for (const char* name : kVariables) unsetenv(name);
    fs::remove_all(root_);
  }

  std::string add(const std::string& path) {
    const fs::path file = root_ / path;
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "solid\n";
    return file.string();
  }
  std::string in(const std::string& path) const { return (root_ / path).string(); }

  // The file found for a mesh of this URI in a URDF at root_/robots/arm/urdf/arm.urdf; empty with a warning.
  std::string find(const std::string& uri, const std::vector<std::string>& package_dirs = {}) {
    Options options;
    options.package_dirs = package_dirs;
    loaded_ = robot("<link name='a'>" + visual("<mesh filename='" + uri + "' scale='-1 1 0.001'/>") +
                        "<collision><geometry><mesh filename='" + uri + "'/></geometry></collision></link>",
                    in("robots/arm/urdf/arm.urdf"), options);
    EXPECT_TRUE(loaded_.ok());
    const GeometryObject& o = loaded_.geometry.visual.at(0);
    EXPECT_EQ(o.shape, Shape::Mesh);
    EXPECT_EQ(o.meshUri, uri);
    EXPECT_EQ(o.scale, Eigen::Vector3d(-1, 1, 0.001));
    EXPECT_EQ(loaded_.geometry.collision.at(0).mesh, o.mesh);
    EXPECT_EQ(loaded_.diagnostics.size(), o.mesh.empty() ? 1u : 0u) << "one warning a file, none when found";
    return o.mesh;
  }

  static constexpr const char* kVariables[] = {"LAB_PACKAGE_PATH", "ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"};
  fs::path root_;
  Loaded loaded_;
};

TEST_F(MeshLookup, UpwardsFromTheUrdf) {
  const std::string inside = add("robots/arm/meshes/hand.dae"), beside = add("robots/tools/drill.dae");
  EXPECT_EQ(find("package://arm/meshes/hand.dae"), inside);
  EXPECT_EQ(find("model://arm/meshes/hand.dae"), inside);
  EXPECT_EQ(find("package://tools/drill.dae"), beside);
  EXPECT_EQ(find("package://robots/arm/meshes/hand.dae"), inside);
}

TEST_F(MeshLookup, RelativeAbsoluteAndFile) {
  const std::string file = add("robots/arm/meshes/hand.dae");
  EXPECT_EQ(find("../meshes/hand.dae"), file);
  EXPECT_EQ(find(file), file);
  EXPECT_EQ(find("file://" + file), file);
  EXPECT_EQ(find("hand.dae"), "");
  EXPECT_EQ(find("hand.dae", {in("robots/arm/meshes")}), file);
}

// Each place is asked before those behind it: files are added from the last place to the first.
TEST_F(MeshLookup, OrderOfPlaces) {
  const std::string uri = "package://arm/m/a.stl";
  EXPECT_EQ(find(uri), "");
  const std::string up = add("robots/arm/m/a.stl");
  EXPECT_EQ(find(uri), up);
  const std::string ament = add("ament/share/arm/m/a.stl");
  setenv("AMENT_PREFIX_PATH", in("ament").c_str(), 1);
  EXPECT_EQ(find(uri), ament);
  const std::string ros = add("ros/arm/m/a.stl");
  setenv("ROS_PACKAGE_PATH", (in("nothing") + "::" + in("ros") + ":").c_str(), 1);
  EXPECT_EQ(find(uri), ros);
  const std::string lab = add("lab/arm/m/a.stl");
  setenv("LAB_PACKAGE_PATH", in("lab/arm/").c_str(), 1);  // the package itself, with a slash at its end
  EXPECT_EQ(find(uri), lab);
  const std::string given = add("given/arm/m/a.stl");
  EXPECT_EQ(find(uri, {in("other"), in("given")}), given);
}

// A mesh that is there, but is not the mesh: the warning names the file and says what to do.
TEST_F(MeshLookup, AMeshThatWasNotFetched) {
  const std::string file = add("robots/arm/meshes/hand.dae");
  std::ofstream(file) << "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n";
  EXPECT_EQ(find("package://arm/meshes/hand.dae"), "");
  EXPECT_NE(loaded_.diagnostics.at(0).message.find(file + " is only a Git LFS pointer: run git lfs pull"),
            std::string::npos);
  std::ofstream(file, std::ios::trunc).flush();
  EXPECT_EQ(find("package://arm/meshes/hand.dae"), "");
  EXPECT_NE(loaded_.diagnostics.at(0).message.find(file + " is empty"), std::string::npos);
}

TEST_F(MeshLookup, AMissingMeshNamesEveryPlace) {
  setenv("ROS_PACKAGE_PATH", in("ros").c_str(), 1);
  fs::create_directories(root_ / "robots/arm/m/folder.stl");  // a folder is no mesh
  EXPECT_EQ(find("package://arm/m/folder.stl", {in("given")}), "");
  const Diagnostic& d = loaded_.diagnostics.at(0);
  EXPECT_EQ(d.severity, Severity::Warning);
  EXPECT_EQ(d.line, 2);
  EXPECT_EQ(d.element, "link 'a'");
  for (const char* place : {"given/arm/m/folder.stl", "ros/arm/m/folder.stl", "robots/arm/m/folder.stl",
                            "robots/arm/urdf/arm/m/folder.stl"}) {
    EXPECT_NE(d.message.find(in(place)), std::string::npos) << place << " not in " << d.message;
  }
  for (const std::string& path :
       mesh_candidates("package://arm/m/folder.stl", in("robots/arm/urdf/arm.urdf"), {})) {
    EXPECT_NE(d.message.find(path), std::string::npos) << path;
  }
}

TEST_F(MeshLookup, OnlyAModelLooksForNone) {
  std::ofstream(in("arm.urdf")) << "<robot name='r'><link name='a'>" + visual("<mesh filename='no.stl'/>") +
                                       "</link></robot>";
  Model model;
  EXPECT_TRUE(buildModel(in("arm.urdf"), model).empty());
  GeometryModel shapes;
  EXPECT_EQ(buildModelsFromUrdf(in("arm.urdf"), {}, model, shapes).size(), 1u);
  EXPECT_EQ(shapes.visual.at(0).mesh, "");
}

}  // namespace
}  // namespace rbd::urdf
