#pragma once

#include <pliant/body/solver_arrays.hpp>
#include <pliant/solver/linear/krylov_scalars.hpp>
#include <pliant/solver/linear/multigrid.hpp>

namespace pliant::detail {

/// What the iterations of a Krylov method on a body's backend work in; copies live on in recordings.
template <class Parts>
class KrylovFields {
 public:
  using T = typename Parts::T;
  static constexpr int dim = Parts::dim;
  using Field = typename Parts::Field;
  using ConstField = typename Parts::ConstField;
  using Arrays = SolverArrays<typename Parts::backend_type>;

  KrylovFields(Parts& parts, Arrays& arrays, ShiftedTangent<Parts> const& matrix)
      : parts_(&parts),
        arrays_(&arrays),
        a(matrix),
        n(parts.layout.rows),
        s{arrays.scalars.data()},
        x(node_field<dim>(arrays.solution)),
        r(node_field<dim>(arrays.residual)),
        p(node_field<dim>(arrays.direction)),
        z(node_field<dim>(arrays.conditioned)),
        q(node_field<dim>(arrays.image)),
        b(node_field<dim>(arrays.right_side)) {}

 private:
  Parts* parts_;
  Arrays* arrays_;

 public:
  ShiftedTangent<Parts> a;
  Index n;
  Scalars s;
  Field x, r, p, z, q, b;  // q = A p has scratch rows

  typename Parts::backend_type const& backend() const { return parts_->backend; }
  Arrays& arrays() const { return *arrays_; }
  static ConstField fixed(Field field) { return {field.data}; }

  void dot_into(Scalars::Name name, Field one, Field other) const {
    backend().add_sum(n, DotAt<T, dim>{fixed(one), fixed(other)}, &s[name]);
  }
  /// b, which stands in r while x is zero.
  void keep_right_hand_side() const { set_sum(backend(), n, b, Scaled<T, dim>{1, fixed(r)}); }
  /// r = b − A x and its square; the direction is lost.
  void find_residual() const {
    set_sum(backend(), n, p, Scaled<T, dim>{1, fixed(x)});
    multiply();
    set_sum(backend(), n, r, Scaled<T, dim>{1, fixed(b)}, Scaled<T, dim>{-1, fixed(q)});
    backend().for_each(1, ClearSquare{s});
    dot_into(Scalars::rr, r, r);
  }
  /// q = A p.
  void multiply() const { a.apply(*parts_, p, q); }
  /// z = M from; q is lost.
  void precondition(Multigrid<Parts> const& by, Field from) const {
    by.apply(*parts_, arrays(), a, from);
  }
  /// z = M from by the inverse blocks of nodes.
  void precondition_by_blocks(Field from) const {
    backend().for_each(n, with_columns(ConditionAt<T, dim>{z, fixed(from), {}}));
  }
  /// A functor with the columns of the inverse blocks.
  template <class Functor>
  Functor with_columns(Functor functor) const {
    for (int k = 0; k < dim; ++k)
      functor.columns[k] = fixed(ShiftedTangent<Parts>::column(*parts_, arrays().blocks.data(), k));
    return functor;
  }
};

}  // namespace pliant::detail
