#include <limits>
#include <vector>

#include <pliant/body/state.hpp>

#include "support/catch.hpp"

namespace pliant::test::copy_values_test {

/// Writes down what it would copy.
struct Recorder {
  struct Piece {
    std::size_t from, to;
    Index count;
  };
  std::vector<Piece>* pieces;
  void for_each(Index count, detail::CopyValue<char> const& copy) const {
    pieces->push_back(
        {reinterpret_cast<std::size_t>(copy.from), reinterpret_cast<std::size_t>(copy.to), count});
  }
};

TEST_CASE("more values than an Index can number are copied whole", "[body]") {
  std::size_t const most = std::numeric_limits<Index>::max();
  for (std::size_t count : {std::size_t{0}, std::size_t{7}, most, most + 1, 5 * most + 3}) {
    CAPTURE(count);
    std::vector<Recorder::Piece> pieces;
    // Nothing is read there.
    auto* const from = reinterpret_cast<char const*>(std::size_t{64});
    auto* const to = reinterpret_cast<char*>(std::size_t{1} << 40);

    detail::copy_values(Recorder{&pieces}, from, to, count);

    std::size_t next = 0;
    for (auto const& piece : pieces) {
      CHECK(piece.count > 0);
      CHECK(piece.from == 64 + next);
      CHECK(piece.to == (std::size_t{1} << 40) + next);
      next += static_cast<std::size_t>(piece.count);
    }
    CHECK(next == count);
  }
}

}  // namespace pliant::test::copy_values_test
