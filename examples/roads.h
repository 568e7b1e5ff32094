// Two roads to one number. Every example ends with such comparisons; its exit code is their verdict.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <iostream>

class Roads {
 public:
  // Prints how far a and b are apart (the length of a - b). More than `tolerance`, or a NaN, is a failure.
  void compare(const char* what, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double tolerance) {
    const bool same_shape = a.rows() == b.rows() && a.cols() == b.cols();
    const double difference = same_shape ? (a - b).norm() : HUGE_VAL;
    const bool ok = difference <= tolerance;
    std::printf("%s  %s: difference %.1e (at most %.0e)\n", ok ? "agree" : "DIFFER", what, difference,
                tolerance);
    failed_ = failed_ || !ok;
  }
  void compare(const char* what, double a, double b, double tolerance) {
    compare(what, Eigen::MatrixXd::Constant(1, 1, a), Eigen::MatrixXd::Constant(1, 1, b), tolerance);
  }
  // 1 too if what was printed could not be written: a verdict that nobody can read is none.
  int exit_code() const {
    std::cout.flush();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      std::perror("cannot write to standard output");
      return 1;
    }
    return failed_ ? 1 : 0;
  }

 private:
  bool failed_ = false;
};
