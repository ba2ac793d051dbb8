#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "gotai/core/hash.h"
#include "gotai/core/types.h"

namespace gotai {
namespace {

Hash128 hash_of(const std::string& text) {
  return Hasher().bytes(text.data(), text.size()).digest();
}

TEST(Hash, AgreesWithThePublishedValuesOfXxh3) {
  EXPECT_EQ(Hasher().digest().hex(), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(hash_of("abc").hex(), "06b05ab6733a618578af5f94892f3950");
}

TEST(Hash, PiecesAreTheWhole) {
  const std::string text(1000, 'x');
  Hasher pieces;
  for (std::size_t i = 0; i < text.size(); i += 7) {
    pieces.bytes(text.data() + i, std::min<std::size_t>(7, text.size() - i));
  }
  EXPECT_EQ(pieces.digest(), hash_of(text));
}

TEST(Hash, SeesEveryBitAndTheOrder) {
  EXPECT_NE(Hasher().value(0.0).digest(), Hasher().value(-0.0).digest());
  EXPECT_NE(Hasher().value(1).value(2).digest(), Hasher().value(2).value(1).digest());
  const Vec3 v(1.0, 2.0, 3.0);
  EXPECT_NE(Hasher().value(v).digest(),
            Hasher().value(Vec3(1.0, 2.0, std::nextafter(3.0, 4.0))).digest());
}

TEST(Hash, ArraysCarryTheirLength) {
  const std::vector<int> both{1, 2, 3};
  const std::span<const int> all(both);
  EXPECT_NE(Hasher().array(all.first(1)).array(all.subspan(1)).digest(),
            Hasher().array(all.first(2)).array(all.subspan(2)).digest());
  EXPECT_NE(Hasher().text("ab").text("c").digest(), Hasher().text("a").text("bc").digest());
}

}  // namespace
}  // namespace gotai
