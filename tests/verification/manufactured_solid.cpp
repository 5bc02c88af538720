#include "verification/support/manufactured.hpp"

// REFERENCES, section 9, in space.
namespace pliant::verification {

template <template <class> class L>
void elements(Table& table, bool full) {
  std::vector<int> linear{6, 9}, quadratic{3, 5};
  if (full) {
    linear = {8, 12, 16};
    quadratic = {4, 6, 8};
  }
  manufactured_rows<Tet4, L>(table, linear);
  manufactured_rows<Hex8, L>(table, linear);
  // The other elements with one law are enough for the quick form.
  if constexpr (has_full_form || std::same_as<L<double>, SaintVenantKirchhoff<double>>) {
    manufactured_rows<Hex8, L, OnePoint>(table, linear);
    manufactured_rows<Wedge6, L>(table, linear);
    manufactured_rows<Pyramid5, L>(table, linear);
    manufactured_rows<Tet10, L>(table, quadratic);
    manufactured_rows<Hex20, L>(table, quadratic);
    manufactured_rows<Hex27, L>(table, quadratic);
  }
}

void tables_of_solids(Table& table) {
  auto const b = force_needed<SaintVenantKirchhoff, 3>({0.3, 0.7, 0.4});
  char const* const digits[] = {"0.318096452163", "0.234068004248", "0.590481838822"};
  for (std::size_t k = 0; k < 3; ++k)
    table.compare({"9, body force " + std::to_string(k + 1) + " at (0.3, 0.7, 0.4)",
                   "SaintVenantKirchhoff", ""},
                  b[k], printed(digits[k]));
  elements<SaintVenantKirchhoff>(table, table.full());
  elements<NeoHookean>(table, table.full());
}

}  // namespace pliant::verification

int main(int argc, char** argv) {
  pliant::verification::Table table("Manufactured solutions, solid (9)", argc, argv);
  pliant::verification::tables_of_solids(table);
  return table.finish();
}
