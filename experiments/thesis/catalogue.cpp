#include "thesis/catalogue.h"

#include "gotai/core/error.h"

namespace gotai::experiments {

const std::vector<Experiment>& all_experiments() {
  static const std::vector<Experiment> all{
      fall(),         superpose(),   throw_(),   drop_time(), slide(),   pile_time(),
      pile_error(),   rocks_error(), polygons(), parallel(),  figures(), animations(),
      cube_on_cube(), stack(),       spin(),     top(),       tunnel()};
  return all;
}

const Experiment& find_experiment(const std::string& id) {
  std::string names;
  for (const Experiment& experiment : all_experiments()) {
    if (experiment.id == id) return experiment;
    names += (names.empty() ? "" : ", ") + experiment.id;
  }
  throw InvalidArgument("experiment", id, "must be one of " + names);
}

}  // namespace gotai::experiments
