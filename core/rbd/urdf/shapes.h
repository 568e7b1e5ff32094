// Visual and collision shapes of the links, with their colours and mesh files.
#pragma once

#include <string>
#include <vector>

#include "rbd/model/geometry.h"
#include "rbd/urdf/xml.h"

namespace rbd::urdf {

struct LinkShape {
  std::string link;
  bool visual = true;     // else a collision shape
  int line = 0;           // of its geometry
  GeometryObject object;  // placement in the link's frame; parentFrame, parentJoint and mesh not set yet
};

// All shapes of a file, link by link in the file's order. A shape of size zero is left out with a warning,
// an impossible one is an error. Colours of named materials are filled in.
std::vector<LinkShape> read_shapes(const tinyxml2::XMLElement& robot, Report& report);

// Where a mesh URI may lie, in the order tried:
//   package://P/x, model://P/x: in each of package_dirs, LAB_PACKAGE_PATH, ROS_PACKAGE_PATH (D/P/x, or D/x
//     if D is called P), AMENT_PREFIX_PATH (D/share/P/x), then in the folders from the URDF upwards (as first)
//   file:///x, /x: as it is
//   x: beside the URDF, then in each of package_dirs
// `urdf` is the path of the URDF file; a bare name without any folder has none of the last kind but ".".
std::vector<std::string> mesh_candidates(const std::string& uri, const std::string& urdf,
                                         const std::vector<std::string>& package_dirs);

// Sets `mesh` of every mesh shape to the first candidate that is a file; warns about the others, once a file.
void find_meshes(std::vector<LinkShape>& shapes, const std::vector<std::string>& package_dirs,
                 Report& report);

}  // namespace rbd::urdf
