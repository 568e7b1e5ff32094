// The kernels' own 3-vectors and 3x3 matrices.
//
// With Eigen's fixed-size types the kernels take 1.6 times as long, with three plain doubles 1.5 to 2.5 times.
// So for double a Vec3 is ONE register of four lanes whose last lane stays 0, and a Mat3 is three of them (its
// columns). For any other Scalar (long double in tests, a packet of many states) a Vec3 is three Scalars. The
// kernels use only the names below, so that one source serves all scalar types.
#pragma once

namespace rbd::inner {

template <class Scalar>
struct Vec3 {
  Scalar x, y, z;

  static Vec3 zero() { return {Scalar(0), Scalar(0), Scalar(0)}; }
  static Vec3 make(Scalar x, Scalar y, Scalar z) { return {x, y, z}; }
  // From packed constants (4 doubles, aligned) or from any three doubles.
  static Vec3 load(const double* p) { return {Scalar(p[0]), Scalar(p[1]), Scalar(p[2])}; }
  static Vec3 loadU(const Scalar* p) { return {p[0], p[1], p[2]}; }
  void storeU(Scalar* p) const {
    p[0] = x;
    p[1] = y;
    p[2] = z;
  }
  Scalar operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }

  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(Vec3 a, Scalar s) { return {a.x * s, a.y * s, a.z * s}; }
  friend Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  friend Scalar dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  // a . b + c . d: one sum over lanes instead of two.
  friend Scalar dot2(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(a, b) + dot(c, d); }
  // a x (0, 0, s).
  friend Vec3 crossZ(Vec3 a, Scalar s) { return {a.y * s, -(a.x * s), Scalar(0)}; }
};

// typedefs, not aliases: clang drops `aligned` from an alias
typedef double Lanes4 __attribute__((vector_size(32)));
typedef double Lanes4Unaligned __attribute__((vector_size(32), aligned(8), may_alias));
typedef double Lanes2Unaligned __attribute__((vector_size(16), aligned(8), may_alias));

inline Lanes4 loadLanes(const double* p) { return *reinterpret_cast<const Lanes4Unaligned*>(p); }
inline void storeLanes(double* p, Lanes4 x) { *reinterpret_cast<Lanes4Unaligned*>(p) = x; }

template <>
struct Vec3<double> {
  Lanes4 d;

  static Vec3 zero() { return {Lanes4{}}; }
  static Vec3 make(double x, double y, double z) { return {Lanes4{x, y, z, 0}}; }
  static Vec3 load(const double* p) { return {loadLanes(p)}; }
  static Vec3 loadU(const double* p) { return {Lanes4{p[0], p[1], p[2], 0}}; }
  // Writes exactly three entries.
  void storeU(double* p) const {
    *reinterpret_cast<Lanes2Unaligned*>(p) = __builtin_shufflevector(d, d, 0, 1);
    p[2] = d[2];
  }
  // Writes a fourth entry too: only for outputs whose next entry is overwritten later.
  void storeWide(double* p) const { storeLanes(p, d); }
  double operator[](int i) const { return d[i]; }

  friend Vec3 operator+(Vec3 a, Vec3 b) { return {a.d + b.d}; }
  friend Vec3 operator-(Vec3 a, Vec3 b) { return {a.d - b.d}; }
  friend Vec3 operator-(Vec3 a) { return {-a.d}; }
  friend Vec3 operator*(Vec3 a, double s) { return {a.d * s}; }
  friend Vec3 cross(Vec3 a, Vec3 b) {
    const Lanes4 a1 = __builtin_shufflevector(a.d, a.d, 1, 2, 0, 3);
    const Lanes4 b1 = __builtin_shufflevector(b.d, b.d, 1, 2, 0, 3);
    const Lanes4 c = a.d * b1 - a1 * b.d;
    return {__builtin_shufflevector(c, c, 1, 2, 0, 3)};
  }
  friend double dot(Vec3 a, Vec3 b) { return sum(a.d * b.d); }
  friend double dot2(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return sum(a.d * b.d + c.d * d.d); }
  friend Vec3 crossZ(Vec3 a, double s) {
    return {__builtin_shufflevector(a.d, a.d, 1, 0, 3, 3) * Lanes4{s, -s, 0, 0}};
  }

 private:
  static double sum(Lanes4 m) { return (m[0] + m[2]) + m[1]; }  // lane 3 is 0
};

template <class Scalar>
struct Mat3 {
  Vec3<Scalar> c0, c1, c2;  // columns

  static Mat3 load(const double* p) {
    return {Vec3<Scalar>::load(p), Vec3<Scalar>::load(p + 4), Vec3<Scalar>::load(p + 8)};
  }
  static Mat3 identity() {
    const Scalar o(0), i(1);
    return {Vec3<Scalar>::make(i, o, o), Vec3<Scalar>::make(o, i, o), Vec3<Scalar>::make(o, o, i)};
  }
  friend Vec3<Scalar> operator*(const Mat3& m, Vec3<Scalar> v) {
    return m.c0 * v[0] + m.c1 * v[1] + m.c2 * v[2];
  }
  friend Mat3 operator*(const Mat3& a, const Mat3& b) { return {a * b.c0, a * b.c1, a * b.c2}; }
  friend Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.c0 + b.c0, a.c1 + b.c1, a.c2 + b.c2}; }
  Mat3 transposed() const {
    return {Vec3<Scalar>::make(c0[0], c1[0], c2[0]), Vec3<Scalar>::make(c0[1], c1[1], c2[1]),
            Vec3<Scalar>::make(c0[2], c1[2], c2[2])};
  }
};

}  // namespace rbd::inner
