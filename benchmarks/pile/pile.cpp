#include "pile/pile.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <sstream>

#include "gotai/core/error.h"
#include "gotai/geometry/load_mesh.h"

namespace gotai::pile {

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
  return pile;
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

}  // namespace gotai::pile
