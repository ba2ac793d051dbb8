// What shapes, bodies and contacts take on the heap.
#include <algorithm>
#include <memory>

#include "gotai/core/error.h"
#include "pile/pile.h"

#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
#include <malloc.h>
#endif

namespace gotai::pile {
namespace {

double heap_bytes() {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
#else
  throw Error("this C library does not tell the size of the heap");
#endif
}

// Bytes of a world of bodies that fall far apart from each other.
double bytes_of_world(const Options& o, const Pile& pile, const ShapePointer& shape, int bodies) {
  Pile apart;
  apart.mesh = pile.mesh;
  apart.inner = Vec3(1e4, 1e4, 10.0);
  for (int k = 0; k < bodies; ++k) {
    const double spacing = 4.0 * shape->bounding_radius;
    Pose X;
    X.p = spacing * Vec3(k % 32, (k / 32) % 32, 100 + k / 1024);
    apart.poses.push_back(X);
  }
  const double before = heap_bytes();
  World world = make_world(o, apart, shape);
  for (int step = 0; step < 10; ++step) world.step();
  return heap_bytes() - before;
}

}  // namespace

Memory measure_memory(const Options& o, const Pile& pile) {
  Memory memory;
  make_pile_shape(o, pile);  // what the first shape leaves behind: threads and tables
  const double before = heap_bytes();
  const ShapePointer shape = make_pile_shape(o, pile);
  memory.shape = heap_bytes() - before;
  memory.surface_model = static_cast<double>(shape->surface.bytes());
  bytes_of_world(o, pile, shape, 1);  // likewise the first world
  const double one = bytes_of_world(o, pile, shape, 1);
  const double few = bytes_of_world(o, pile, shape, 1000);
  const double many = bytes_of_world(o, pile, shape, 3000);
  memory.per_body = (many - few) / 2000.0;
  memory.prepared = one - memory.per_body;
  const double empty = heap_bytes();
  World world = make_world(o, pile, shape);
  std::size_t contacts = 0;
  while (!world.has_reached(o.seconds)) {
    world.step();
    contacts = std::max(contacts, world.contacts().size());
  }
  const double in_bodies = memory.per_body * static_cast<double>(world.bodies().size());
  memory.per_contact = (heap_bytes() - empty - memory.prepared - in_bodies) /
                       static_cast<double>(std::max<std::size_t>(1, contacts));
  return memory;
}

}  // namespace gotai::pile
