#include <random>

#include <pliant/topology/shared_list.hpp>

#include "support/catch.hpp"

// Copies of a SharedList, and what changes in one of them.
namespace pliant::test {

TEST_CASE("copies of a shared list change by themselves", "[topology]") {
  std::mt19937 random(1);
  auto const any = [&](std::size_t count) { return random() % count; };
  // Lists, and what they should be.
  std::vector<SharedList<int>> lists(1);
  std::vector<std::vector<int>> models(1);
  for (int round = 0; round < 4000; ++round) {
    std::size_t const i = any(lists.size());
    auto& list = lists[i];
    auto& model = models[i];
    switch (any(5)) {
      case 0:
        for (std::size_t k = any(300); k > 0; --k) {
          list.push_back(round);
          model.push_back(round);
        }
        break;
      case 1:
        if (model.empty()) break;
        for (int k = 0; k < 3; ++k) {
          std::size_t const at = any(model.size());
          list.edit(at) = model[at] = -round;
        }
        break;
      case 2:
        model.resize(model.size() - any(model.size() / 8 + 1));
        list.shrink(model.size());
        break;
      case 3: {
        std::size_t const first = any(model.size() + 1), one_in = 50 + any(50);
        auto const stays = [&](std::size_t place) { return place % one_in != 0; };
        list.keep(first, stays);
        std::vector<int> left;
        for (std::size_t k = 0; k < model.size(); ++k)
          if (k < first || stays(k)) left.push_back(model[k]);
        model = left;
        break;
      }
      default:
        if (lists.size() < 8) {
          auto const copy = list;
          lists.push_back(copy);
          models.push_back(std::vector<int>(model));
        } else {
          std::size_t const other = any(lists.size());
          auto const copy = list;
          auto const copy_of_model = model;
          lists[other] = copy;
          models[other] = copy_of_model;
        }
    }
  }
  for (std::size_t i = 0; i < lists.size(); ++i) {
    CHECK(models[i].size() > 256);  // more than a block
    CHECK(std::vector<int>(lists[i].begin(), lists[i].end()) == models[i]);
  }
}

}  // namespace pliant::test
