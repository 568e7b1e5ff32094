// Argument types of the core for vectors and matrices: any Eigen object of that memory layout, without a copy.
#pragma once

#include <Eigen/Core>

namespace rbd {

using ConstVectorRef = Eigen::Ref<const Eigen::VectorXd>;
using VectorRef = Eigen::Ref<Eigen::VectorXd>;
using MatrixRef = Eigen::Ref<Eigen::MatrixXd>;

}  // namespace rbd
