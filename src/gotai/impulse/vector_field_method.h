/// @file
/// The vector field: repulsion before touching [Makino 2007, section 2.3.5].
#pragma once

#include "gotai/impulse/method.h"
#include "gotai/impulse/spring_forces.h"

namespace gotai::impulse {

/// F = k (1 - d/delta)_+ n for every pair of contact candidates at distance d, within the range
/// delta = 2 s of the voxel edge s, plus damping along n; divided by the pair's candidates in
/// range. The thesis gives no formula; this is ours. k stops a body that falls from its own size:
///   k delta / 2 = m |g| 2 rho.
///
/// Reads every contact candidate within the range.
/// Guarantees: bodies feel each other before they touch; damping returns about the restitution of
/// the materials, 1 keeps bouncing. Does not: let bodies touch: they hover where the field carries
/// their weight, about one range above the ground, so the error is of the order of the voxel.
class VectorFieldMethod final : public ImpulseMethod {
 public:
  explicit VectorFieldMethod(const model::Settings& settings);

  model::StepPlan plan(const model::BodyState& bodies, double dt) const override;
  void prepare(const model::BodyState& bodies, const model::ContactSet& contacts,
               const model::MaterialTable& materials, const model::StepPlan& plan,
               const model::ContactMemory& memory) override;
  void solve(const model::BodyState& bodies, const std::vector<double>& gap,
             model::Update& update) override;
  void finish(const model::BodyState& bodies, model::Update& update,
              model::ContactMemory& memory) override;
  model::SolveReport report() const override { return springs_.report(); }

 private:
  model::Settings settings_;
  Springs springs_;
};

}  // namespace gotai::impulse
