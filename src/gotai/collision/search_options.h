/// @file
/// What a search for contacts may know of the step that it is made for.
#pragma once

#include <span>

#include "gotai/model/contact_anchors.h"
#include "gotai/model/contact_memory.h"
#include "gotai/model/settings.h"

namespace gotai::collision {

/// Defaults find every contact within the margin.
struct SearchOptions {
  /// `reduced` keeps few contacts per pair (model `surface`); others keep all.
  model::ContactTreatment contacts = model::ContactTreatment::all;
  /// The step [s]. When > 0, the model `surface` finds contacts of a pair only as far as its bodies
  /// move in it, and leaves out contacts that cannot close.
  double dt = 0.0;
  /// Impulses of the last step, sorted by (body_a, body_b, feature): `reduced` keeps what carried.
  std::span<const model::ContactMemory::Entry> memory;
  /// What earlier steps found, updated by the search. The model `surface`, in a step with `reduced`
  /// contacts, takes those of pairs that hardly moved from here. Null: all are found anew.
  model::ContactAnchors* anchors = nullptr;
};

}  // namespace gotai::collision
