// Floating-point filter, then exact expansion arithmetic (Shewchuk 1997, "Adaptive Precision
// Floating-Point Arithmetic and Fast Robust Geometric Predicates").
#include "gotai/geometry/predicates.h"

#include <array>
#include <cmath>
#include <limits>

namespace gotai::geometry::detail {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon() / 2.0;

int sign_of(double x) { return x > 0.0 ? 1 : (x < 0.0 ? -1 : 0); }

/// A sum of doubles without rounding error: components of growing magnitude that do not overlap.
template <std::size_t kCapacity>
class Expansion {
 public:
  /// Shewchuk's GROW-EXPANSION with zero elimination.
  void add(double b) {
    double carry = b;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = carry + parts_[i];
      const double virtual_part = sum - carry;
      const double error = (carry - (sum - virtual_part)) + (parts_[i] - virtual_part);
      carry = sum;
      if (error != 0.0) parts_[kept++] = error;
    }
    if (carry != 0.0) parts_[kept++] = carry;
    size_ = kept;
  }
  /// Adds x y z.
  void add_product(double x, double y, double z) {
    const double high = x * y;
    const double low = std::fma(x, y, -high);
    for (const double part : {low, high}) {
      const double product = part * z;
      add(std::fma(part, z, -product));
      add(product);
    }
  }
  int sign() const { return size_ == 0 ? 0 : sign_of(parts_[size_ - 1]); }

 private:
  std::array<double, kCapacity> parts_;
  std::size_t size_ = 0;
};

/// The determinant of the rows (p, 1), developed along the ones: every term is a product of three
/// input numbers, so nothing is rounded.
int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Expansion<24 * 4 + 1> sum;
  const auto add_det = [&sum](double sign, const Vec3& p, const Vec3& q, const Vec3& r) {
    sum.add_product(sign * p.x(), q.y(), r.z());
    sum.add_product(sign * p.y(), q.z(), r.x());
    sum.add_product(sign * p.z(), q.x(), r.y());
    sum.add_product(-sign * p.x(), q.z(), r.y());
    sum.add_product(-sign * p.y(), q.x(), r.z());
    sum.add_product(-sign * p.z(), q.y(), r.x());
  };
  // det(b-a, c-a, d-a) = det(b,c,d) - det(a,c,d) + det(a,b,d) - det(a,b,c)
  add_det(1.0, b, c, d);
  add_det(-1.0, a, c, d);
  add_det(1.0, a, b, d);
  add_det(-1.0, a, b, c);
  return sum.sign();
}

int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  Expansion<6 * 4 + 1> sum;
  const auto add_det = [&sum](const Vec2& p, const Vec2& q) {
    sum.add_product(p.x(), q.y(), 1.0);
    sum.add_product(-p.y(), q.x(), 1.0);
  };
  add_det(a, b);
  add_det(b, c);
  add_det(c, a);
  return sum.sign();
}

}  // namespace

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const Vec3 w = d - a;
  const double det = w.x() * (u.y() * v.z() - u.z() * v.y()) +
                     w.y() * (u.z() * v.x() - u.x() * v.z()) +
                     w.z() * (u.x() * v.y() - u.y() * v.x());
  const double permanent = std::abs(w.x()) * (std::abs(u.y() * v.z()) + std::abs(u.z() * v.y())) +
                           std::abs(w.y()) * (std::abs(u.z() * v.x()) + std::abs(u.x() * v.z())) +
                           std::abs(w.z()) * (std::abs(u.x() * v.y()) + std::abs(u.y() * v.x()));
  // Shewchuk's bound for this formula, generously rounded up.
  if (std::abs(det) > 8.0 * kEpsilon * permanent) return sign_of(det);
  // What meshes are full of: corners in common, and faces in a plane of the axes.
  if (d == a || d == b || d == c) return 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (u[axis] == 0.0 && v[axis] == 0.0 && w[axis] == 0.0) return 0;
  }
  return exact_orientation(a, b, c, d);
}

int orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (b.x() - a.x()) * (c.y() - a.y());
  const double right = (b.y() - a.y()) * (c.x() - a.x());
  if (std::abs(left - right) > 4.0 * kEpsilon * (std::abs(left) + std::abs(right)))
    return sign_of(left - right);
  if (c == a || c == b) return 0;
  return exact_orientation(a, b, c);
}

}  // namespace gotai::geometry::detail
