#include "gotai/voxel/exact_orientation.h"

#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace gotai::voxel {
namespace {

/// A number as the exact sum of doubles that do not overlap, smallest first, without zeros
/// [Shewchuk 1997, section 2].
template <std::size_t Capacity>
struct Expansion {
  std::array<double, Capacity> part;
  std::size_t size = 0;

  /// Grow-Expansion: adds one double.
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const double sum = value + part[i];
      const double rounded = sum - value;
      const double error = (value - (sum - rounded)) + (part[i] - rounded);
      if (error != 0.0) part[kept++] = error;
      value = sum;
    }
    if (value != 0.0) {
      assert(kept < Capacity);
      part[kept++] = value;
    }
    size = kept;
  }

  int sign() const {
    if (size == 0) return 0;
    return part[size - 1] > 0.0 ? 1 : -1;
  }
};

/// a - b, exactly.
Expansion<2> difference(double a, double b) {
  Expansion<2> result;
  result.add(a);
  result.add(-b);
  return result;
}

/// sum += sign * a * b, exactly.
template <std::size_t C, std::size_t A, std::size_t B>
void add_product(Expansion<C>& sum, const Expansion<A>& a, const Expansion<B>& b, double sign) {
  for (std::size_t i = 0; i < a.size; ++i) {
    for (std::size_t j = 0; j < b.size; ++j) {
      const double product = sign * a.part[i] * b.part[j];
      sum.add(std::fma(sign * a.part[i], b.part[j], -product));
      sum.add(product);
    }
  }
}

/// a0 b1 - a1 b0, exactly.
Expansion<16> cross(const Expansion<2>& a0, const Expansion<2>& a1, const Expansion<2>& b0,
                    const Expansion<2>& b1) {
  Expansion<16> result;
  add_product(result, a0, b1, 1.0);
  add_product(result, a1, b0, -1.0);
  return result;
}

int sign_of(double value) { return value > 0.0 ? 1 : (value < 0.0 ? -1 : 0); }

constexpr double kEpsilon = 0.5 * std::numeric_limits<double>::epsilon();

}  // namespace

int exact_orientation(const Vec2& a, const Vec2& b, const Vec2& p) {
  const double left = (b.x() - a.x()) * (p.y() - a.y());
  const double right = (b.y() - a.y()) * (p.x() - a.x());
  const double filter = (3.0 + 16.0 * kEpsilon) * kEpsilon * (std::abs(left) + std::abs(right));
  if (std::abs(left - right) > filter) return sign_of(left - right);
  return cross(difference(b.x(), a.x()), difference(b.y(), a.y()), difference(p.x(), a.x()),
               difference(p.y(), a.y()))
      .sign();
}

int exact_orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  // (b - a) x (c - a) . (a - p) = det(a - p, b - p, c - p).
  const Vec3 u = a - p;
  const Vec3 v = b - p;
  const Vec3 w = c - p;
  const Vec3 left(v.y() * w.z(), v.z() * w.x(), v.x() * w.y());
  const Vec3 right(v.z() * w.y(), v.x() * w.z(), v.y() * w.x());
  const double determinant = u.dot(left - right);
  const double permanent = u.cwiseAbs().dot(left.cwiseAbs() + right.cwiseAbs());
  if (std::abs(determinant) > (7.0 + 56.0 * kEpsilon) * kEpsilon * permanent)
    return sign_of(determinant);

  std::array<Expansion<2>, 3> eu;
  std::array<Expansion<2>, 3> ev;
  std::array<Expansion<2>, 3> ew;
  for (int k = 0; k < 3; ++k) {
    const auto s = static_cast<std::size_t>(k);
    eu[s] = difference(a[k], p[k]);
    ev[s] = difference(b[k], p[k]);
    ew[s] = difference(c[k], p[k]);
  }
  Expansion<192> sum;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t k1 = (k + 1) % 3;
    const std::size_t k2 = (k + 2) % 3;
    add_product(sum, cross(ev[k1], ev[k2], ew[k1], ew[k2]), eu[k], 1.0);
  }
  return sum.sign();
}

}  // namespace gotai::voxel
