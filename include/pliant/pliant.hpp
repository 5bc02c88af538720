#pragma once

// Everything that is independent of a backend, but the solvers that assemble sparse matrices:
// <pliant/solver/newton.hpp>.
#include <pliant/adaptation/adaptation.hpp>
#include <pliant/adaptation/criterion/combine.hpp>
#include <pliant/adaptation/criterion/deformation.hpp>
#include <pliant/adaptation/criterion/force_intensity.hpp>
#include <pliant/adaptation/criterion/shape.hpp>
#include <pliant/adaptation/evaluate.hpp>
#include <pliant/adaptation/strategy.hpp>
#include <pliant/backend/backend.hpp>
#include <pliant/body/body.hpp>
#include <pliant/body/ledger.hpp>
#include <pliant/config.hpp>
#include <pliant/element/simplex.hpp>
#include <pliant/element/tensor.hpp>
#include <pliant/error.hpp>
#include <pliant/law/hooke.hpp>
#include <pliant/law/neo_hookean.hpp>
#include <pliant/law/saint_venant_kirchhoff.hpp>
#include <pliant/mesh/box.hpp>
#include <pliant/mesh/rectangle.hpp>
#include <pliant/quadrature/gauss.hpp>
#include <pliant/solver/central_difference.hpp>
