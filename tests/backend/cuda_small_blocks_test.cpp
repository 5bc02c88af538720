#include <set>
#include <vector>

#include <pliant/cuda/small_blocks.hpp>

#include "support/catch.hpp"

// Which of a device's memory is kept for work to come; by numbers in place of memory.
namespace pliant::test {

using detail::SmallBlocks;

TEST_CASE("blocks are as large as the next power of two", "[cuda]") {
  CHECK(SmallBlocks::size_for(1) == SmallBlocks::smallest);
  CHECK(SmallBlocks::size_for(256) == 256);
  CHECK(SmallBlocks::size_for(257) == 512);
  CHECK(SmallBlocks::size_for(65536) == 65536);
  CHECK(SmallBlocks::is_small(65536));
  CHECK_FALSE(SmallBlocks::is_small(65537));
}

TEST_CASE("a block is taken once, and for no more bytes than it has", "[cuda]") {
  SmallBlocks blocks;
  std::vector<char> memory(4);
  CHECK(blocks.take(300) == nullptr);
  REQUIRE(blocks.keep(&memory[0], 300));
  REQUIRE(blocks.keep(&memory[1], 65536));
  REQUIRE(blocks.keep(&memory[2], 1));

  CHECK(blocks.take(513) == nullptr);
  CHECK(blocks.take(512) == &memory[0]);
  CHECK(blocks.take(512) == nullptr);
  CHECK(blocks.take(256) == &memory[2]);
  CHECK(blocks.take(32769) == &memory[1]);
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

}  // namespace pliant::test
