#include "pile/pile.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <sstream>

#include "gotai/core/error.h"
#include "gotai/geometry/load_mesh.h"

namespace gotai::pile {

namespace {

// Copies of the pile side by side, without the walls between them.
void repeat(const Options& o, Pile& pile) {
  const std::vector<Pose> once = pile.poses;
  const Vec3 inner = pile.inner;
  pile.inner.x() *= o.copies_x;
  pile.inner.y() *= o.copies_y;
  pile.poses.clear();
  for (int j = 0; j < o.copies_y; ++j) {
    for (int i = 0; i < o.copies_x; ++i) {
      const Vec3 shift((i - 0.5 * (o.copies_x - 1)) * inner.x(),
                       (j - 0.5 * (o.copies_y - 1)) * inner.y(), 0.0);
      for (const Pose& X : once) pile.poses.push_back({X.p + shift, X.q});
    }
  }
}

}  // namespace

Pile read_pile(const Options& o) {
  Pile pile;
  pile.mesh = geometry::load_mesh(o.folder + "/" + o.mesh + ".obj", {}).mesh;
  const std::string path = fmt::format("{}/{}_{}.csv", o.folder, o.mesh, o.bodies);
  std::ifstream in(path);
  std::string line;
  if (!std::getline(in, line) || line.find(':') == std::string::npos) {
    throw FileError(path, "does not start with the size of the container");
  }
  std::istringstream header(line.substr(line.find(':') + 1));
  double count = 0.0;
  header >> count >> pile.inner.x() >> pile.inner.z();
  pile.inner.y() = pile.inner.x();
  std::getline(in, line);  // names of the columns
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    Pose X;
    row >> X.p.x() >> X.p.y() >> X.p.z() >> X.q.w() >> X.q.x() >> X.q.y() >> X.q.z();
    X.q.normalize();
    pile.poses.push_back(X);
  }
  repeat(o, pile);
  for (Pose& X : pile.poses) X.p.x() += o.shift;
  return pile;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace gotai::pile
