#include <set>
#include <vector>

#include <pliant/cuda/small_blocks.hpp>

#include "support/catch.hpp"

// Which of a device's memory is kept for work to come; by numbers in place of memory.
namespace pliant::test {

using detail::SmallBlocks;

TEST_CASE("blocks have four sizes between one power of two and the next", "[cuda]") {
  CHECK(SmallBlocks::size_for(1) == SmallBlocks::smallest);
  CHECK(SmallBlocks::size_for(256) == 256);
  CHECK(SmallBlocks::size_for(257) == 320);
  CHECK(SmallBlocks::size_for(320) == 320);
  CHECK(SmallBlocks::size_for(385) == 448);
  CHECK(SmallBlocks::size_for(449) == 512);
  CHECK(SmallBlocks::size_for(65536) == 65536);
  CHECK(SmallBlocks::size_for(65537) == 81920);
  CHECK(SmallBlocks::size_for(SmallBlocks::largest) == SmallBlocks::largest);
  CHECK(SmallBlocks::is_small(SmallBlocks::largest));
  CHECK_FALSE(SmallBlocks::is_small(SmallBlocks::largest + 1));
}

TEST_CASE("each size has blocks of its own", "[cuda]") {
  SmallBlocks blocks;
  std::vector<std::size_t> sizes;
  for (std::size_t bytes = 1; bytes <= SmallBlocks::largest; bytes = sizes.back() + 1)
    sizes.push_back(SmallBlocks::size_for(bytes));
  CHECK(sizes.size() == 57);
  CHECK(sizes.back() == SmallBlocks::largest);
  std::vector<char> memory(sizes.size());
  for (std::size_t k = 0; k < sizes.size(); ++k) REQUIRE(blocks.keep(&memory[k], sizes[k]));
  for (std::size_t k = sizes.size(); k-- > 0;) {
    CHECK(blocks.take(k == 0 ? 1 : sizes[k - 1] + 1) == &memory[k]);
    CHECK(blocks.take(sizes[k]) == nullptr);
  }
}

TEST_CASE("a block is taken once, and for no more bytes than it has", "[cuda]") {
  SmallBlocks blocks;
  std::vector<char> memory(4);
  CHECK(blocks.take(300) == nullptr);
  REQUIRE(blocks.keep(&memory[0], 300));
  REQUIRE(blocks.keep(&memory[1], 65536));
  REQUIRE(blocks.keep(&memory[2], 1));

  CHECK(blocks.take(321) == nullptr);
  CHECK(blocks.take(320) == &memory[0]);
  CHECK(blocks.take(320) == nullptr);
  CHECK(blocks.take(256) == &memory[2]);
  CHECK(blocks.take(57345) == &memory[1]);
  CHECK(blocks.take(65536) == nullptr);
}

TEST_CASE("so many blocks of a size are kept, and all are handed over", "[cuda]") {
  SmallBlocks blocks;
  std::size_t const most = SmallBlocks::most_of_a_size;
  std::vector<char> memory(2 * most + 1);
  for (std::size_t k = 0; k < most; ++k) {
    REQUIRE(blocks.keep(&memory[k], 1000));
    REQUIRE(blocks.keep(&memory[most + k], 2000));
  }
  CHECK_FALSE(blocks.keep(&memory[2 * most], 1000));

  std::set<void*> handed;
  blocks.clear([&](void* block) { CHECK(handed.insert(block).second); });
  CHECK(handed.size() == 2 * most);
  CHECK(handed.count(&memory[2 * most]) == 0);
  CHECK(blocks.take(1000) == nullptr);
  CHECK(blocks.take(2000) == nullptr);
}

TEST_CASE("of large blocks fewer are kept", "[cuda]") {
  SmallBlocks blocks;
  std::vector<char> memory(3);
  CHECK(SmallBlocks::most_of(SmallBlocks::smallest) == SmallBlocks::most_of_a_size);
  CHECK(SmallBlocks::most_of(SmallBlocks::largest) == 2);
  for (std::size_t k = 0; k < 2; ++k) REQUIRE(blocks.keep(&memory[k], SmallBlocks::largest));
  CHECK_FALSE(blocks.keep(&memory[2], SmallBlocks::largest));
}

}  // namespace pliant::test
