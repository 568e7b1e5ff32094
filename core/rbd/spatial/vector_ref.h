// What the functions of the core take for vectors and matrices: any Eigen object with that memory layout, uncopied.
#pragma once

#include <Eigen/Core>

namespace rbd {

using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;
using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

}  // namespace rbd
