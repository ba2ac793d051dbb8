#include "gotai/voxel/surface_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "gotai/core/random.h"
#include "gotai/voxel/sample_grid.h"

namespace gotai::voxel {
namespace {

constexpr double kMildAngle = 0.09;       // convex edges above it attract samples [rad]
constexpr double kFaceRadius = 0.90;      // of the spacing, between face samples
constexpr double kEdgeRadius = 0.7;       // of the spacing, between samples of sharp edges
constexpr double kCornerRadius = 0.3;     // of the spacing, between sharp corners
constexpr double kAloneLength = 0.75;     // of the spacing, of edges between corners
constexpr double kStraight = 0.999;       // cosine: edges that go on in one line
constexpr double kSameSide = 0.5;         // cosine: normals of one side of a thin part
constexpr double kDensePerSpacing = 4.0;  // dense points per spacing and direction
constexpr int kRelaxations = 2;

// A point of the dense cover of the surface, which areas and averages are taken over.
struct DensePoint {
  Vec3 position;
  Vec3 normal;
  double area;
};

Box3 box_of(const SignedDistance& surface) {
  Box3 box;
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v) box.extend(surface.vertex(v));
  return box;
}

// Signed angle between the normals across an edge: > 0 where the surface is convex [rad].
double dihedral(const SignedDistance& surface, std::uint32_t triangle, int edge) {
  const std::uint32_t other = surface.neighbor(triangle, edge);
  if (other == SignedDistance::kNoTriangle) return std::numbers::pi;
  const Vec3& n = surface.face_normal(triangle);
  const Vec3& m = surface.face_normal(other);
  const auto& t = surface.corners(triangle);
  const auto e = static_cast<std::size_t>(edge);
  const Vec3 along = surface.vertex(t[(e + 1) % 3]) - surface.vertex(t[e]);
  const double angle = std::atan2(n.cross(m).norm(), n.dot(m));
  return n.cross(m).dot(along) >= 0.0 ? angle : -angle;
}

// What the faces around a vertex are like.
struct VertexFan {
  Vec3 normal_sum = Vec3::Zero();
  std::vector<Vec3> face_normals;
  std::vector<Vec3> sharp_directions;     // along the sharp convex edges, away from the vertex
  std::vector<std::uint32_t> sharp_ends;  // the other ends of those edges
  double largest_angle = 0.0;             // convex dihedral angle
};

class Sampler {
 public:
  Sampler(const SignedDistance& surface, double spacing)
      : surface_(surface), spacing_(spacing), box_(box_of(surface)), grid_(box_, spacing) {}

  std::vector<SurfaceSample> run() {
    collect_fans();
    place_corners();
    place_sharp_edges();
    place_mild_vertices();
    cover_densely();
    place_faces();
    for (int i = 0; i < kRelaxations; ++i) {
      assign();
      relax();
    }
    assign();
    finish();
    collect_vertices();
    return std::move(samples_);
  }

 private:
  void collect_fans() {
    fans_.resize(surface_.vertex_count());
    for (std::uint32_t t = 0; t < surface_.triangle_count(); ++t) {
      const Vec3& n = surface_.face_normal(t);
      if (n.isZero()) continue;
      const auto& corner = surface_.corners(t);
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t i = corner[e];
        const std::uint32_t j = corner[(e + 1) % 3];
        fans_[i].face_normals.push_back(n);
        fans_[i].normal_sum += angle_at(corner, e) * n;
        const std::uint32_t other = surface_.neighbor(t, static_cast<int>(e));
        if (other != SignedDistance::kNoTriangle && other < t) continue;
        const double angle = dihedral(surface_, t, static_cast<int>(e));
        fans_[i].largest_angle = std::max(fans_[i].largest_angle, angle);
        fans_[j].largest_angle = std::max(fans_[j].largest_angle, angle);
        if (angle > kSharpAngle) {
          const Vec3 along = (surface_.vertex(j) - surface_.vertex(i)).normalized();
          fans_[i].sharp_directions.push_back(along);
          fans_[j].sharp_directions.push_back(-along);
          fans_[i].sharp_ends.push_back(j);
          fans_[j].sharp_ends.push_back(i);
        }
      }
    }
  }

  // Angle of a triangle at corner e: weights that do not depend on how a face is cut up.
  double angle_at(const geometry::Triangle& corner, std::size_t e) const {
    const Vec3 u = surface_.vertex(corner[(e + 1) % 3]) - surface_.vertex(corner[e]);
    const Vec3 v = surface_.vertex(corner[(e + 2) % 3]) - surface_.vertex(corner[e]);
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }

  static bool is_corner(const VertexFan& fan) {
    const auto& d = fan.sharp_directions;
    if (d.empty()) return false;
    return d.size() != 2 || d[0].dot(d[1]) > -std::cos(kSharpAngle);
  }

  SurfaceSample vertex_sample(std::uint32_t v, SampleKind kind) const {
    SurfaceSample s;
    s.position = surface_.vertex(v);
    s.kind = kind;
    s.normal = fans_[v].normal_sum;
    if (s.normal.squaredNorm() < 1e-12) s.normal = fans_[v].face_normals.front();
    s.normal.normalize();
    for (const Vec3& n : fans_[v].face_normals) {
      s.cone_cosine = std::min(s.cone_cosine, s.normal.dot(n));
    }
    return s;
  }

  // Is no sample of this side nearer than the radius?
  bool is_free(const Vec3& x, const Vec3& normal, double radius) const {
    constexpr double kTaken = -1.0;  // nothing else needs to be looked at
    double reach = radius * radius;
    grid_.visit(x, reach, [&](const GridSample& s) {
      const bool takes =
          (s.position - x).squaredNorm() < radius * radius && s.normal.dot(normal) > kSameSide;
      return reach = takes ? kTaken : reach;
    });
    return reach != kTaken;
  }

  // Adds a sample unless one that can stand for it is nearer than the radius.
  void add(const SurfaceSample& s, double radius) {
    if (!is_free(s.position, s.normal, radius)) return;
    grid_.insert({s.position, s.normal, kSameSide, static_cast<std::uint32_t>(samples_.size())});
    samples_.push_back(s);
  }

  void place_corners() {
    for (std::uint32_t v = 0; v < fans_.size(); ++v) {
      if (is_corner(fans_[v])) {
        add(vertex_sample(v, SampleKind::corner), kCornerRadius * spacing_);
      }
    }
  }

  void place_sharp_edges() {
    for (std::uint32_t t = 0; t < surface_.triangle_count(); ++t) {
      if (surface_.face_normal(t).isZero()) continue;
      for (int e = 0; e < 3; ++e) {
        const std::uint32_t other = surface_.neighbor(t, e);
        if (other != SignedDistance::kNoTriangle && other < t) continue;
        if (dihedral(surface_, t, e) > kSharpAngle) place_along(t, e, other);
      }
    }
  }

  // How far a sharp edge goes on straight beyond a vertex that it comes to [m], up to a length.
  double straight_on(std::uint32_t vertex, const Vec3& direction, double most) const {
    double length = 0.0;
    while (length < most) {
      const VertexFan& fan = fans_[vertex];
      const auto on = std::find_if(fan.sharp_directions.begin(), fan.sharp_directions.end(),
                                   [&](const Vec3& d) { return d.dot(direction) > kStraight; });
      if (fan.sharp_directions.size() != 2 || on == fan.sharp_directions.end()) break;
      const std::uint32_t next =
          fan.sharp_ends[static_cast<std::size_t>(on - fan.sharp_directions.begin())];
      length += (surface_.vertex(next) - surface_.vertex(vertex)).norm();
      vertex = next;
    }
    return std::min(length, most);
  }

  void place_along(std::uint32_t triangle, int edge, std::uint32_t other) {
    const auto e = static_cast<std::size_t>(edge);
    const std::uint32_t from = surface_.corners(triangle)[e];
    const std::uint32_t to = surface_.corners(triangle)[(e + 1) % 3];
    const Vec3 a = surface_.vertex(from);
    const Vec3 b = surface_.vertex(to);
    const double length = (b - a).norm();
    // Between two corners at least one sample has to know the edge.
    const bool stands_alone =
        is_corner(fans_[from]) && is_corner(fans_[to]) && length > kAloneLength * spacing_;
    const int intervals = std::max(stands_alone ? 2 : 1,
                                   static_cast<int>(std::ceil(length / (kEdgeSpacing * spacing_))));
    SurfaceSample s;
    s.kind = SampleKind::edge;
    s.edge_direction = (b - a) / length;
    s.normal = surface_.face_normal(triangle);
    if (other != SignedDistance::kNoTriangle) {
      const Vec3 sum = s.normal + surface_.face_normal(other);
      if (sum.squaredNorm() > 1e-12) s.normal = sum.normalized();
    }
    s.cone_cosine = s.normal.dot(surface_.face_normal(triangle));
    const double before = straight_on(from, -s.edge_direction, spacing_);
    const double after = straight_on(to, s.edge_direction, spacing_);
    for (int k = 0; k <= intervals; ++k) {
      const double along = length * k / intervals;
      s.position = a + along * s.edge_direction;
      s.reach_back = std::min(along + before, spacing_);
      s.reach_forward = std::min(length - along + after, spacing_);
      const bool at_end = k == 0 || k == intervals;
      add(s, (at_end ? kEdgeRadius : 0.5 * kEdgeRadius) * spacing_);
    }
  }

  // Vertices of gently convex regions are where a coarse polyhedron touches.
  void place_mild_vertices() {
    for (std::uint32_t v = 0; v < fans_.size(); ++v) {
      if (fans_[v].largest_angle > kMildAngle && fans_[v].sharp_directions.empty()) {
        add(vertex_sample(v, SampleKind::face), kFaceRadius * spacing_);
      }
    }
    fixed_ = samples_.size();
  }

  // Low-discrepancy points on every triangle (R2 sequence, Roberts 2018), folded into it.
  void cover_densely() {
    const double step = spacing_ / kDensePerSpacing;
    for (std::uint32_t t = 0; t < surface_.triangle_count(); ++t) {
      const Vec3& n = surface_.face_normal(t);
      if (n.isZero()) continue;
      const auto& corner = surface_.corners(t);
      const Vec3& a = surface_.vertex(corner[0]);
      const Vec3 u = surface_.vertex(corner[1]) - a;
      const Vec3 v = surface_.vertex(corner[2]) - a;
      const double area = 0.5 * u.cross(v).norm();
      const double longest =
          std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()}));
      const int count = static_cast<int>(
          std::max({1.0, std::ceil(area / (step * step)), std::ceil(longest / (2.0 * step))}));
      double x = 0.5;
      double y = 0.5;
      for (int k = 0; k < count; ++k) {
        x += 0.7548776662466927;
        y += 0.5698402909980532;
        x -= std::floor(x);
        y -= std::floor(y);
        const bool fold = x + y > 1.0;
        dense_.push_back(
            {a + (fold ? 1.0 - x : x) * u + (fold ? 1.0 - y : y) * v, n, area / count});
      }
    }
  }

  void place_faces() {
    std::vector<std::uint32_t> order(dense_.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    Random random(1);
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1], order[random.next_u32() % i]);
    }
    // In this order nothing is where the memory expects it.
    constexpr std::size_t kAhead = 8;
    for (std::size_t at = 0; at < order.size(); ++at) {
      __builtin_prefetch(&dense_[order[std::min(at + 2 * kAhead, order.size() - 1)]]);
      grid_.prefetch(dense_[order[std::min(at + kAhead, order.size() - 1)]].position);
      const std::uint32_t i = order[at];
      const double radius = kFaceRadius * spacing_;
      if (!is_free(dense_[i].position, dense_[i].normal, radius)) continue;
      SurfaceSample s;
      s.position = dense_[i].position;
      s.normal = dense_[i].normal;
      add(s, radius);
    }
  }

  SampleGrid grid_of_samples() const {
    std::vector<GridSample> all;
    all.reserve(samples_.size());
    for (std::uint32_t i = 0; i < samples_.size(); ++i) all.push_back(grid_sample(i));
    SampleGrid grid(box_, spacing_);
    grid.insert_all(std::move(all));
    return grid;
  }

  GridSample grid_sample(std::uint32_t i) const {
    const SurfaceSample& s = samples_[i];
    return {s.position, s.normal, std::min(kSameSide, s.cone_cosine - 1e-9), i};
  }

  // The nearest sample, of the side that faces along the normal if there is one.
  std::uint32_t nearest_sample(const SampleGrid& grid, const Vec3& x, const Vec3& normal) const {
    const double other_side = 1e3 * spacing_ * spacing_;
    std::uint32_t nearest = 0;
    double best = std::numeric_limits<double>::infinity();
    grid.visit(x, best, [&](const GridSample& s) {
      const bool is_same_side = s.normal.dot(normal) > s.same_side;
      const double squared = (s.position - x).squaredNorm() + (is_same_side ? 0.0 : other_side);
      if (squared < best || (squared == best && s.index < nearest)) {
        best = squared;
        nearest = s.index;
      }
      return best;
    });
    return nearest;
  }

  // Gives every dense point to the nearest sample of its side.
  void assign() {
    owner_.resize(dense_.size());
    const SampleGrid grid = grid_of_samples();
    for (std::size_t d = 0; d < dense_.size(); ++d) {
      owner_[d] = nearest_sample(grid, dense_[d].position, dense_[d].normal);
    }
  }

  void collect_vertices() {
    constexpr double kFlat = 1e-3;  // [rad]
    const SampleGrid grid = grid_of_samples();
    for (std::uint32_t v = 0; v < fans_.size(); ++v) {
      if (!(fans_[v].largest_angle > kFlat)) continue;
      const Vec3& x = surface_.vertex(v);
      SurfaceSample& s =
          samples_[nearest_sample(grid, x, vertex_sample(v, SampleKind::face).normal)];
      if (s.kind == SampleKind::face && (s.position - x).norm() > 1e-6 * spacing_) {
        s.vertices.push_back(x);
      }
    }
  }

  // Lloyd's step for face samples: to the dense point that is nearest to the cell's centroid.
  void relax() {
    std::vector<Vec3> centroid(samples_.size(), Vec3::Zero());
    std::vector<double> area(samples_.size(), 0.0);
    for (std::size_t d = 0; d < dense_.size(); ++d) {
      centroid[owner_[d]] += dense_[d].area * dense_[d].position;
      area[owner_[d]] += dense_[d].area;
    }
    std::vector<double> best(samples_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t d = 0; d < dense_.size(); ++d) {
      const std::uint32_t i = owner_[d];
      if (i < fixed_) continue;
      const double squared = (dense_[d].position - centroid[i] / area[i]).squaredNorm();
      if (squared < best[i]) {
        best[i] = squared;
        samples_[i].position = dense_[d].position;
        samples_[i].normal = dense_[d].normal;
      }
    }
  }

  void finish() {
    for (std::size_t d = 0; d < dense_.size(); ++d) {
      samples_[owner_[d]].area += dense_[d].area;
      samples_[owner_[d]].vector_area += dense_[d].area * dense_[d].normal;
    }
    for (SurfaceSample& s : samples_) {
      if (s.kind != SampleKind::face || s.vector_area.norm() < 0.1 * s.area) continue;
      if (s.area > 0.0) {
        s.normal = s.vector_area.normalized();
        s.cone_cosine = 1.0;
      }
    }
    for (std::size_t d = 0; d < dense_.size(); ++d) {
      SurfaceSample& s = samples_[owner_[d]];
      if (s.kind != SampleKind::face) continue;
      s.cone_cosine = std::min(s.cone_cosine, std::max(0.0, s.normal.dot(dense_[d].normal)));
    }
  }

  const SignedDistance& surface_;
  double spacing_;
  Box3 box_;
  std::vector<VertexFan> fans_;
  std::vector<SurfaceSample> samples_;
  SampleGrid grid_;
  std::size_t fixed_ = 0;  // samples before it stay where they are
  std::vector<DensePoint> dense_;
  std::vector<std::uint32_t> owner_;
};

}  // namespace

std::vector<SurfaceSample> sample_surface(const SignedDistance& surface, double spacing) {
  return Sampler(surface, spacing).run();
}

}  // namespace gotai::voxel
