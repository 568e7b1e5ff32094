// What every program of `lab bench core` shares, ours and the peers': the robot file, the states, the
// stop-watch, the lines. Plain C++17 without a library, so that a peer needs nothing of ours.
//
// Robot file (bench-robots writes it): one line a word of numbers,
//   robot NAME NQ NV
//   joint NAME PARENT KIND  axis(3)  rotation(9, by rows) translation(3)  mass com(3) Ixx Iyy Izz Ixy Ixz Iyz
//   state  q(NQ) v(NV) a(NV) tau(NV)
// PARENT 0 is the world, joints count from 1, depth first. KIND: revolute, prismatic, freeflyer (first joint
// only). Placement in the parent joint's frame; inertia about the centre of mass, along the joint's axes. A
// free-flyer has q = position, quaternion xyzw; v and a = body twist, angular first.
//
// Lines on stdout:  PEER ROBOT ALGORITHM MIN_NS MEDIAN_NS,  and  # check PEER ROBOT quantity=value ..
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace bench {

struct Joint {
  std::string name, kind;
  int parent;
  double axis[3], rotation[9], translation[3], mass, com[3], inertia[6];
};

struct State {
  std::vector<double> q, v, a, tau;
};

struct Robot {
  std::string name;
  int nq = 0, nv = 0;
  std::vector<Joint> joints;
  std::vector<State> states;
  bool floating() const { return !joints.empty() && joints[0].kind == "freeflyer"; }
  int base() const { return floating() ? 6 : 0; }  // the first dof that belongs to a joint
};

inline Robot read(const std::string& file) {
  Robot robot;
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  for (std::string line, word; std::getline(in, line);) {
    std::istringstream text(line);
    const auto numbers = [&](auto& list) {
      for (double& x : list) text >> x;
    };
    text >> word;
    if (word == "robot") {
      text >> robot.name >> robot.nq >> robot.nv;
    } else if (word == "joint") {
      Joint j;
      text >> j.name >> j.parent >> j.kind;
      numbers(j.axis);
      numbers(j.rotation);
      numbers(j.translation);
      text >> j.mass;
      numbers(j.com);
      numbers(j.inertia);
      robot.joints.push_back(j);
    } else {
      const std::size_t nq = static_cast<std::size_t>(robot.nq), nv = static_cast<std::size_t>(robot.nv);
      State s{std::vector<double>(nq), std::vector<double>(nv), std::vector<double>(nv),
              std::vector<double>(nv)};
      numbers(s.q);
      numbers(s.v);
      numbers(s.a);
      numbers(s.tau);
      robot.states.push_back(s);
    }
    if (!text) throw std::runtime_error(file + ": bad line: " + line.substr(0, 60));
  }
  if (robot.states.empty()) throw std::runtime_error(file + ": no states");
  return robot;
}

/// Means over all states of quantities that do not depend on how a library writes down a floating base: when
/// they agree, the libraries computed the same.
class Check {
 public:
  void add(const std::string& quantity, double value) {
    for (auto& [name, sum, count] : sums_) {
      if (name == quantity) {
        sum += value;
        ++count;
        return;
      }
    }
    sums_.push_back({quantity, value, 1});
  }
  void print(const std::string& peer, const Robot& robot) const {
    std::printf("# check %s %s", peer.c_str(), robot.name.c_str());
    for (const auto& [name, sum, count] : sums_) std::printf(" %s=%.12g", name.c_str(), sum / count);
    std::printf("\n");
  }

 private:
  struct Sum {
    std::string name;
    double sum;
    int count;
  };
  std::vector<Sum> sums_;
};

/// Length of the joints' part of a vector or matrix diagonal: x(i) for base <= i < nv.
template <class F>
double norm(int base, int nv, F&& x) {
  double sum = 0;
  for (int i = base; i < nv; ++i) sum += x(i) * x(i);
  return std::sqrt(sum);
}
template <class F>
double sum(int base, int nv, F&& x) {
  double total = 0;
  for (int i = base; i < nv; ++i) total += x(i);
  return total;
}

/// The stop-watch, and what was asked for:  PROGRAM [--quick] [--only ALGORITHM,..] ROBOT-FILE..
class Bench {
 public:
  Bench(std::string peer, int argc, char** argv) : peer_(std::move(peer)) {
    for (int i = 1; i < argc; ++i) {
      const std::string word = argv[i];
      if (word == "--quick") {
        blocks_ = 3;
        block_ns_ = 1e5;
      } else if (word == "--only" && i + 1 < argc) {
        only_ = std::string(",") + argv[++i] + ",";
      } else {
        files_.push_back(word);
      }
    }
  }

  const std::string& peer() const { return peer_; }
  const std::vector<std::string>& files() const { return files_; }

  /// From here on the compiler must assume that what `results` points to is read.
  static void watch(const void* results) { asm volatile("" : : "r"(results) : "memory"); }

  /// Times f(i), which computes `algorithm` of state i: `blocks_` blocks of about `block_ns_`, each over all
  /// states. Prints nanoseconds per call: the fastest block and the median one.
  template <class F>
  void row(const Robot& robot, const char* algorithm, F&& f) const {
    if (!only_.empty() && only_.find(std::string(",") + algorithm + ",") == std::string::npos) return;
    const auto round = [&] {
      for (std::size_t i = 0; i < robot.states.size(); ++i) {
        f(i);
        asm volatile("" : : : "memory");
      }
    };
    round();  // warm: caches, branch predictors, pages
    const double start = now();
    int rounds = 0;
    for (; now() - start < block_ns_; ++rounds) round();
    std::vector<double> ns;
    for (int block = 0; block < blocks_; ++block) {
      const double t = now();
      for (int i = 0; i < rounds; ++i) round();
      ns.push_back((now() - t) / (rounds * static_cast<double>(robot.states.size())));
    }
    std::sort(ns.begin(), ns.end());
    std::printf("%s %s %s %.1f %.1f\n", peer_.c_str(), robot.name.c_str(), algorithm, ns.front(),
                ns[ns.size() / 2]);
    std::fflush(stdout);
  }

 private:
  static double now() {
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  std::string peer_, only_;
  std::vector<std::string> files_;
  int blocks_ = 25;
  double block_ns_ = 2.5e6;
};

/// main() of a peer: measures every file with `measure(bench, robot)`; a robot it cannot do is a comment.
template <class F>
int run(const char* peer, int argc, char** argv, F&& measure) {
  const Bench bench(peer, argc, argv);
  int failed = 0;
  for (const std::string& file : bench.files()) {
    try {
      measure(bench, read(file));
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s: %s: %s\n", peer, file.c_str(), e.what());
      failed = 1;
    }
    std::fflush(stdout);
  }
  return failed;
}

}  // namespace bench
