/// @file
/// Contacts as they were found when their pair was last searched. State: saved and hashed, because
/// what a later step takes from here it does not find anew.
#pragma once

#include <vector>

#include "gotai/core/types.h"
#include "gotai/model/contact_set.h"

namespace gotai::model {

/// Pairs that touched or nearly touched in the last step, with the contacts of the pose in which
/// they were searched last. Sorted by (body_a, body_b); frames A and B are the bodies' (centre of
/// mass, axes of the body). Written by collision; holds for the shapes that the bodies have.
struct ContactAnchors {
  struct Contact {
    Vec3 point_A = Vec3::Zero();     ///< on body a [m]
    Vec3 point_B = Vec3::Zero();     ///< on body b [m]
    Vec3 normal_B = Vec3::Zero();    ///< unit, from b to a
    Vec3 friction_A = Vec3::Zero();  ///< where friction acts [m]
    double area = 0.0;               ///< surface that it stands for [m^2]
    FeatureKey feature = 0;
  };
  struct Pair {
    BodyIndex body_a = 0;
    BodyIndex body_b = 0;
    Pose X_BA;           ///< of body a in frame B when the pair was searched
    double reach = 0.0;  ///< up to which gap contacts were searched [m]
    std::vector<Contact> contacts;
  };
  std::vector<Pair> pairs;
};

/// Drops what is known of a body that is erased, and renumbers those after it.
inline void erase_body(ContactAnchors& anchors, BodyIndex removed) {
  std::erase_if(anchors.pairs, [removed](const ContactAnchors::Pair& pair) {
    return pair.body_a == removed || pair.body_b == removed;
  });
  for (ContactAnchors::Pair& pair : anchors.pairs) {
    if (pair.body_a > removed) --pair.body_a;
    if (pair.body_b > removed) --pair.body_b;
  }
}

}  // namespace gotai::model
