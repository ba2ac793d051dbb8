#include "gotai/render/geometry_scene.h"

#include <limits>

#include "gotai/core/error.h"
#include "gotai/render/surface_normals.h"

namespace gotai::render {
namespace {

RTCRay make_ray(const Vec3f& origin, const Vec3f& direction, float far) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tfar = far;
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

}  // namespace

GeometryScene::GeometryScene(const view::RunView& run)
    : run_(run), device_(rtcNewDevice("threads=1")) {
  if (device_ == nullptr) throw Error("Embree does not work on this processor");
  top_ = rtcNewScene(device_);
  for (const view::ShapeView& shape : run.shapes) add_shape(shape);
  for (std::uint32_t body = 0; body < run.bodies.size(); ++body) {
    if (run.bodies[body].geometry != model::Geometry::shape) continue;
    Instance instance{.body = body, .shape = run.bodies[body].shape};
    instance.geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance.geometry, shapes_[instance.shape].scene);
    rtcAttachGeometryByID(top_, instance.geometry, static_cast<unsigned>(instances_.size()));
    instances_.push_back(instance);
  }
}

GeometryScene::~GeometryScene() {
  for (const Instance& instance : instances_) rtcReleaseGeometry(instance.geometry);
  for (const ShapeScene& shape : shapes_) rtcReleaseScene(shape.scene);
  rtcReleaseScene(top_);
  rtcReleaseDevice(device_);
}

void GeometryScene::add_shape(const view::ShapeView& shape) {
  const geometry::Mesh& mesh = *shape.mesh;
  ShapeScene out;
  out.scene = rtcNewScene(device_);
  out.normals = corner_normals(mesh);
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  for (const Vec3& vertex : mesh.vertices) {
    // About the centre of mass, which is where a body's pose is.
    Eigen::Map<Vec3f>{vertices} = (vertex - shape.center_of_mass).cast<float>();
    vertices += 3;
  }
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  for (const geometry::Triangle& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) *indices++ = vertex;
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(out.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(out.scene);
  shapes_.push_back(std::move(out));
}

void GeometryScene::place(const view::FrameView& frame) {
  for (Instance& instance : instances_) {
    if (!frame.is_present(instance.body)) {
      rtcDisableGeometry(instance.geometry);
    } else {
      rtcEnableGeometry(instance.geometry);
      instance.rotation = frame.q_WB[instance.body].toRotationMatrix().cast<float>();
      Eigen::Matrix<float, 3, 4> transform;  // columns one after the other
      transform << instance.rotation, frame.x_W[instance.body].cast<float>();
      rtcSetGeometryTransform(instance.geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR,
                              transform.data());
    }
    rtcCommitGeometry(instance.geometry);
  }
  rtcCommitScene(top_);
}

std::optional<BodyHit> GeometryScene::intersect(const Vec3f& origin, const Vec3f& direction) const {
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(top_, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const Instance& instance = instances_[query.hit.instID[0]];
  const Vec3f* corner = &shapes_[instance.shape].normals[std::size_t{3} * query.hit.primID];
  const float u = query.hit.u;
  const float v = query.hit.v;
  Vec3f normal = (instance.rotation * ((1.0F - u - v) * corner[0] + u * corner[1] + v * corner[2]))
                     .normalized();
  if (normal.dot(direction) > 0.0F) normal = -normal;
  return BodyHit{query.ray.tfar, instance.body, normal};
}

bool GeometryScene::occluded(const Vec3f& origin, const Vec3f& direction, float distance) const {
  RTCRay ray = make_ray(origin, direction, distance);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(top_, &context, &ray);
  return ray.tfar < 0.0F;
}

}  // namespace gotai::render
