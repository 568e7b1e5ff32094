// What the sensors say: the noise by its moments and distribution, delay and noise against the truth.
#include "procs/simulator/sensors.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "procs/simulator/noise.h"
#include "procs/simulator/simulator.h"
#include "tests/support/refusal.h"

namespace lab::simulator {
namespace {

constexpr int kMany = 400'000;
const double kSampling = 5 / std::sqrt(double{kMany});  // five standard errors of a mean of unit variance

TEST(Noise, TheMixerIsSplitMix64) {
  // the first outputs of its authors' reference program for the states 0 and 1234567
  EXPECT_EQ(mix(0), 0xe220a8397b1dcdafu);
  EXPECT_EQ(mix(1234567), 6457827717110365317u);
}

// Mean, variance, skewness and kurtosis of a Gaussian are 0, 1, 0, 3; the variances of x^2, x^3, x^4 are 2, 15, 96.
TEST(Noise, ItsMomentsAreAGaussians) {
  double sum[5] = {};
  for (int k = 0; k < kMany; ++k) {
    const double x = gaussian(42, k / 7, k % 7, k % 2 ? NoiseKind::Position : NoiseKind::Velocity);
    for (int power = 1; power <= 4; ++power) sum[power] += std::pow(x, power) / kMany;
  }
  EXPECT_NEAR(sum[1], 0, kSampling);
  EXPECT_NEAR(sum[2], 1, std::sqrt(2.0) * kSampling);
  EXPECT_NEAR(sum[3], 0, std::sqrt(15.0) * kSampling);
  EXPECT_NEAR(sum[4], 3, std::sqrt(96.0) * kSampling);
}

TEST(Noise, ItsDistributionIsAGaussians) {  // Kolmogorov, Smirnov: beyond 2.2 / sqrt(n) once in 8000 times
  std::vector<double> x(kMany);
  for (int k = 0; k < kMany; ++k) x[k] = gaussian(0, k, 1, NoiseKind::Position);
  std::sort(x.begin(), x.end());
  double worst = 0;
  for (int k = 0; k < kMany; ++k)
    worst = std::max(worst, std::abs(0.5 * std::erfc(-x[k] / std::sqrt(2.0)) - (k + 0.5) / kMany));
  EXPECT_LT(worst, 2.2 / std::sqrt(double{kMany}));
}

TEST(Noise, NeighboursHaveNothingToDoWithEachOther) {
  const auto correlation = [](const std::function<double(int)>& a, const std::function<double(int)>& b) {
    double sum = 0;
    for (int k = 0; k < kMany; ++k) sum += a(k) * b(k) / kMany;
    return sum;
  };
  const auto noise = [](int64_t seed, int64_t shift, int joint, NoiseKind kind) {
    return [=](int k) { return gaussian(seed, k + shift, joint, kind); };
  };
  const auto base = noise(1, 0, 1, NoiseKind::Position);
  EXPECT_NEAR(correlation(base, noise(1, 1, 1, NoiseKind::Position)), 0, kSampling) << "the next step";
  EXPECT_NEAR(correlation(base, noise(1, 0, 2, NoiseKind::Position)), 0, kSampling) << "the next joint";
  EXPECT_NEAR(correlation(base, noise(1, 0, 1, NoiseKind::Velocity)), 0, kSampling) << "the other kind";
  EXPECT_NEAR(correlation(base, noise(2, 0, 1, NoiseKind::Position)), 0, kSampling) << "the next seed";
  EXPECT_NEAR(correlation(base, noise(-1, 0, 1, NoiseKind::Position)), 0, kSampling) << "a negative seed";
  EXPECT_NEAR(correlation(base, base), 1, std::sqrt(2.0) * kSampling) << "itself: the test can fail";
}

TEST(Noise, DependsOnNothingButItsArguments) {
  std::vector<double> forth, back;
  for (int k = 0; k < 100; ++k) forth.push_back(gaussian(5, k, 3, NoiseKind::Velocity));
  for (int k = 100; k-- > 0;) back.push_back(gaussian(5, k, 3, NoiseKind::Velocity));
  std::reverse(back.begin(), back.end());
  EXPECT_EQ(forth, back);
}

rbd::Model arm() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  return model;
}

Command wave(int k) { return {.tau = Eigen::VectorXd::Constant(6, std::sin(0.1 * k)), .state_step = k}; }

TEST(Sensors, SayWhatWasAndTheRobotDoesNotCare) {
  Experiment e;
  e.simulator.q0.value = std::vector<double>{0.3, 0.8, -0.5, 0.4, 0.6, 0.2};
  const Config clean = make_config(e, arm());
  e.simulator.delay = 0.003;
  e.simulator.noise.q.value = JointValues::Named{{"joint3_elbow", 0.01}};
  e.simulator.noise.v.value = 0.2;
  e.seed = 9;
  const Config dirty = make_config(e, arm());
  ASSERT_EQ(dirty.sensors.delay, 3);
  State one = initial(clean), other = initial(dirty);
  std::vector<RobotState> truth{one.robot}, seen{sensed(dirty, other)};
  for (int k = 0; k < 500; ++k) {
    const Command command = wave(k);
    truth.push_back(step(clean, one, {.command = &command}).state);
    seen.push_back(step(dirty, other, {.command = &command}).state);
    ASSERT_EQ(other.robot.q, truth.back().q) << "the same tau, the same motion, to the last bit";
    ASSERT_EQ(other.robot.v, truth.back().v);
  }
  const int elbow = static_cast<int>(arm().getJointId("joint3_elbow")) - 1;
  for (int k = 0; k <= 500; ++k) {
    const RobotState& was = truth[std::max(k - 3, 0)];
    EXPECT_EQ(seen[k].step, k);
    EXPECT_EQ(seen[k].tau, truth[k].tau);
    for (int i = 0; i < 6; ++i) {
      const double q = i == elbow ? 0.01 * gaussian(9, k, i + 1, NoiseKind::Position) : 0,
                   v = 0.2 * gaussian(9, k, i + 1, NoiseKind::Velocity);
      EXPECT_NEAR(seen[k].q[i] - was.q[i], q, 4e-16 * 4);  // one rounding of a number below 4
      EXPECT_NEAR(seen[k].v[i] - was.v[i], v, 4e-16 * 16);
      if (q == 0) {
        EXPECT_EQ(seen[k].q[i], was.q[i]) << "to the last bit";
      }
    }
  }
}

std::string refusal(const Experiment& e, const rbd::Model& model) {
  return test::refusal_of([&] { make_config(e, model); });
}

TEST(Sensors, SayWhatTheyCannotDo) {
  Experiment e;
  e.file = "x.yaml";
  e.simulator.delay = 0.002;
  e.logger.every = 10;
  EXPECT_EQ(refusal(e, arm()),
            "x.yaml: logger.every: is 10, but with noise or delay the true states can only be found from "
            "every step; give 1");
  e.logger.every = 1;
  e.simulator.dt = 1e-6;
  e.simulator.delay = 0.5;
  EXPECT_EQ(refusal(e, arm()), "x.yaml: simulator.delay: 0.5 s are 500000 steps; give at most 10000");
  e = Experiment();
  e.file = "x.yaml";
  e.simulator.allow_fall = true;
  rbd::Model humanoid;
  rbd::buildModels::humanoid(humanoid);
  e.simulator.noise.q.value = 0.01;
  EXPECT_EQ(refusal(e, humanoid), "accepted") << "the joints' noise, not the base's";
  EXPECT_EQ(make_config(e, humanoid).sensors.noisy.size(), static_cast<size_t>(humanoid.njoints - 2));
  e.simulator.noise.v.value = std::vector<double>(static_cast<size_t>(humanoid.nv), 0.1);
  EXPECT_EQ(refusal(e, humanoid),
            "x.yaml: simulator.noise.v: joint '" + humanoid.names[1] +
                "' has several degrees of freedom and is seen without noise; leave it out or give 0");
}

}  // namespace
}  // namespace lab::simulator
