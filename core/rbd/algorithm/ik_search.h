// The search behind inverseKinematics (sources: there). Nothing is checked here, and nothing allocates.
#pragma once

#include "rbd/algorithm/inverse_kinematics.h"

namespace rbd::inner {

// Whether the target is farther from the first joint of its chain than the chain can be long, whatever the
// angles: the triangle inequality.
bool outOfReach(const Model& model, const FrameTarget& target, double tolerance);

struct IkErrors {
  double cost = std::numeric_limits<double>::infinity();  // |e|^2 / 2
  double position = std::numeric_limits<double>::infinity(), rotation = 0;
};

// One problem, and the steps of its search on the scratch.
class IkSearch {
 public:
  IkSearch(const Model& model, IkScratch& s, std::span<const FrameTarget> targets, const IkOptions& options)
      : model_(model), s_(s), targets_(targets), options_(options) {
    for (const FrameTarget& target : targets_) rows_ += target.rotation ? 6 : 3;
  }

  // From s.at, as near to the targets as one start leads; s.at becomes the answer.
  IkStop reach(IkErrors& errors);
  // With the targets met at s.at: towards the rest configuration, and still met.
  void relax(IkErrors& errors);
  // Into the limits.
  void clamp(Eigen::VectorXd& q) const {
    q = q.cwiseMax(model_.lowerPositionLimit).cwiseMin(model_.upperPositionLimit);
  }
  bool converged(const IkErrors& errors) const {
    return errors.position <= options_.position_tolerance && errors.rotation <= options_.rotation_tolerance;
  }
  // Of the joints that stand at a limit, the one with the largest gradient beyond its limit; 0 if there is none.
  JointIndex limit() const;
  int iterations() const { return iterations_; }

 private:
  IkErrors evaluate(const Eigen::VectorXd& q);
  void linearise();
  double predictedReduction() const;
  bool step(double lambda);
  bool blocked(Eigen::Index k) const;
  bool stationary() const;

  const Model& model_;
  IkScratch& s_;
  std::span<const FrameTarget> targets_;
  const IkOptions& options_;
  Eigen::Index rows_ = 0;
  int iterations_ = 0;
  double size_ = 0;  // Frobenius norm of J, squared
};

}  // namespace rbd::inner
