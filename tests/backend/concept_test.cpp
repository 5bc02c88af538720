#include <pliant/reference.hpp>

#include "support/catch.hpp"

namespace pliant::test {

/// A backend, and others that lack one verb each.
namespace lacking {
using Whole = Reference<double>;
struct Nothing : Whole {};
struct ForEach : Whole {
  void for_each() const;
};
struct Sum : Whole {
  void sum() const;
};
struct AddSum : Whole {
  void add_sum() const;
};
struct Histogram : Whole {
  void histogram() const;
};
struct Select : Whole {
  template <class F>
  void select(Index, F const&, Index*, Index*) const;
};
struct SelectTo : Whole {
  template <class F>
  std::vector<Index> select(Index, F const&) const;
};
struct Scan : Whole {
  void scan() const;
};
struct Sort : Whole {
  void sort() const;
};
struct Maximum : Whole {
  void maximum() const;
};
struct Arrays : Whole {
  void array() const;
};
struct Record : Whole {
  void record() const;
};
struct TimerOfSeconds : Whole {
  struct Timer {
    void start();
    void stop();
  };
  Timer timer() const;
};
struct Synchronize : Whole {
  void synchronize(int) const;
};
struct Accumulate : Whole {
  void accumulate() const;
};
struct SumElements : Whole {
  void sum_elements() const;
};
struct Visit : Whole {
  void visit() const;
};
struct Patches : Whole {
  template <int Nodes>
  struct Elements : Whole::Elements<Nodes> {
    using Whole::Elements<Nodes>::Elements;
    void patch_count() const;
  };
};
}  // namespace lacking
TEST_CASE("what lacks one verb is no backend", "[backend]") {
  STATIC_REQUIRE(Backend<lacking::Nothing>);
  STATIC_REQUIRE_FALSE(Backend<lacking::ForEach>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Sum>);
  STATIC_REQUIRE_FALSE(Backend<lacking::AddSum>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Histogram>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Maximum>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Select>);
  STATIC_REQUIRE_FALSE(Backend<lacking::SelectTo>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Scan>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Sort>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Arrays>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Record>);
  STATIC_REQUIRE_FALSE(Backend<lacking::TimerOfSeconds>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Synchronize>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Accumulate>);
  STATIC_REQUIRE_FALSE(Backend<lacking::SumElements>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Visit>);
  STATIC_REQUIRE_FALSE(Backend<lacking::Patches>);
}

}  // namespace pliant::test
