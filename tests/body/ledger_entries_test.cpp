#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <pliant/body/ledger_entries.hpp>

#include "support/catch.hpp"

// Entries of a ledger, which copies share.
namespace pliant::test {

TEST_CASE("copies of a ledger's entries change by themselves", "[body]") {
  using Entry = LedgerEntry<2>;
  struct Ledger {
    LedgerEntries<2> entries;
    std::vector<Entry> expected;
  };
  std::mt19937 random(1);
  auto const any = [&](std::size_t count) { return random() % count; };
  std::vector<Ledger> ledgers(4);
  std::size_t most = 0;
  for (int round = 0; round < 4000; ++round) {
    auto& [entries, expected] = ledgers[any(4)];
    switch (any(5)) {
      case 0:
      case 1:
      case 2: {
        Entry const entry{1.0 * round, std::to_string(round), 1, 0.25 * round, -0.125, {1, 2}};
        entries.push_back(entry);
        expected.push_back(entry);
        break;
      }
      case 3:
        if (expected.empty()) break;
        CHECK(entries.take_back().time == expected.back().time);
        expected.pop_back();
        break;
      default:
        ledgers[any(4)] = Ledger{entries, expected};
    }
    for (auto const& [own, model] : ledgers) {
      bool same = own.size() == model.size();
      double sum = 0;
      std::size_t i = 0;
      for (Entry const& entry : own) {
        same = same && entry.action == model[i].action && own[i].time == model[i].time;
        sum += model[i].strain_energy + model[i].kinetic_energy;
        ++i;
      }
      REQUIRE((same && i == model.size()));
      REQUIRE(own.energy() == sum);
      most = std::max(most, i);
    }
  }
  REQUIRE(most > 256);
}

}  // namespace pliant::test
