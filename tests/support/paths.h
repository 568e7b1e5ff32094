// Where a test finds the sources and the programs of its build. The folders are compiled into one small library, not into
// each test, so that ccache serves the tests of one clone to all others.
#pragma once

#include <string>

namespace lab {

/// The path of a file of the repository, such as "models/simple_3dof_arm.urdf".
std::string source_path(const std::string& file);

/// The path of a file of the build folder, such as "bin/lab-model".
std::string build_path(const std::string& file);

}  // namespace lab
