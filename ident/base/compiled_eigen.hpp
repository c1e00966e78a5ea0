#pragma once

#include <Eigen/Dense>

/// Eigen's inner loops for dense matrices of doubles. They are compiled once, in compiled_eigen.cpp; otherwise they
/// take a third of the compile time of a file that multiplies and solves. The precompiled headers begin with this
/// header, so no source file includes it. A file that is compiled without this header, or with another version of
/// Eigen, compiles the loops itself.
#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4 && EIGEN_MINOR_VERSION == 0
#ifndef MODEBANK_EIGEN_TEMPLATE
#define MODEBANK_EIGEN_TEMPLATE extern template
#endif

namespace Eigen {

namespace internal {

using Doubles = gebp_traits<double, double>;
using ColumnsIn = const_blas_data_mapper<double, Index, ColMajor>;
using RowsIn = const_blas_data_mapper<double, Index, RowMajor>;
using Out = blas_data_mapper<double, Index, ColMajor, Unaligned, 1>;
template <class Mapper, int Order, bool Panel>
using PackLeft = gemm_pack_lhs<double, Index, Mapper, Doubles::mr, Doubles::LhsProgress, Doubles::LhsPacket4Packing,
                               Order, false, Panel>;
template <class Mapper, int Order, bool Panel>
using PackRight = gemm_pack_rhs<double, Index, Mapper, Doubles::nr, Order, false, Panel>;
template <class Matrix, int MatrixOrder, class Vector, int Version>
using MatrixByVector =
    general_matrix_vector_product<Index, double, Matrix, MatrixOrder, false, double, Vector, false, Version>;

// Matrix times matrix.
MODEBANK_EIGEN_TEMPLATE void gebp_kernel<double, double, Index, Out, Doubles::mr, Doubles::nr, false,
                                         false>::operator()(const Out&, const double*, const double*, Index, Index,
                                                            Index, double, Index, Index, Index, Index);
// NOLINTBEGIN(bugprone-macro-parentheses): templates and types cannot stand in parentheses.
#define MODEBANK_EIGEN_PACKING(Pack, Mapper, Order, Panel)                                                         \
  MODEBANK_EIGEN_TEMPLATE void Pack<Mapper, Order, Panel>::operator()(double*, const Mapper&, Index, Index, Index, \
                                                                      Index)
MODEBANK_EIGEN_PACKING(PackLeft, ColumnsIn, ColMajor, false);
MODEBANK_EIGEN_PACKING(PackLeft, RowsIn, RowMajor, false);
MODEBANK_EIGEN_PACKING(PackLeft, Out, ColMajor, true);
MODEBANK_EIGEN_PACKING(PackRight, ColumnsIn, ColMajor, false);
MODEBANK_EIGEN_PACKING(PackRight, ColumnsIn, ColMajor, true);
MODEBANK_EIGEN_PACKING(PackRight, RowsIn, RowMajor, false);
MODEBANK_EIGEN_PACKING(PackRight, RowsIn, RowMajor, true);
MODEBANK_EIGEN_PACKING(PackRight, Out, ColMajor, true);
#undef MODEBANK_EIGEN_PACKING
#define MODEBANK_EIGEN_PRODUCT(LeftOrder, RightOrder)                                                          \
  MODEBANK_EIGEN_TEMPLATE void                                                                                 \
  general_matrix_matrix_product<Index, double, LeftOrder, false, double, RightOrder, false, ColMajor, 1>::run( \
      Index, Index, Index, const double*, Index, const double*, Index, double*, Index, Index, double,          \
      level3_blocking<double, double>&, GemmParallelInfo<Index>*)
MODEBANK_EIGEN_PRODUCT(ColMajor, ColMajor);
MODEBANK_EIGEN_PRODUCT(ColMajor, RowMajor);
MODEBANK_EIGEN_PRODUCT(RowMajor, ColMajor);
MODEBANK_EIGEN_PRODUCT(RowMajor, RowMajor);
#undef MODEBANK_EIGEN_PRODUCT

// Matrix times vector.
#define MODEBANK_EIGEN_PRODUCT(Matrix, Order, Vector, Version)                      \
  MODEBANK_EIGEN_TEMPLATE void MatrixByVector<Matrix, Order, Vector, Version>::run( \
      Index, Index, const Matrix&, const Vector&, double*, Index, double)
MODEBANK_EIGEN_PRODUCT(ColumnsIn, ColMajor, RowsIn, 0);
MODEBANK_EIGEN_PRODUCT(ColumnsIn, ColMajor, ColumnsIn, 0);
MODEBANK_EIGEN_PRODUCT(RowsIn, RowMajor, ColumnsIn, 0);
MODEBANK_EIGEN_PRODUCT(RowsIn, RowMajor, ColumnsIn, 1);
MODEBANK_EIGEN_PRODUCT(RowsIn, RowMajor, RowsIn, 1);
#undef MODEBANK_EIGEN_PRODUCT

// Triangular matrix times matrix, and its solve.
#define MODEBANK_EIGEN_PRODUCT(Mode, TriangleOrder)                                                                  \
  MODEBANK_EIGEN_TEMPLATE void                                                                                       \
  product_triangular_matrix_matrix<double, Index, Mode, true, TriangleOrder, false, ColMajor, false, ColMajor,       \
                                   1>::run(Index, Index, Index, const double*, Index, const double*, Index, double*, \
                                           Index, Index, const double&, level3_blocking<double, double>&)
MODEBANK_EIGEN_PRODUCT(Lower, ColMajor);
MODEBANK_EIGEN_PRODUCT(Upper, RowMajor);
MODEBANK_EIGEN_PRODUCT(UnitLower, ColMajor);
MODEBANK_EIGEN_PRODUCT(UnitUpper, RowMajor);
#undef MODEBANK_EIGEN_PRODUCT
#define MODEBANK_EIGEN_SOLUTION(Side, Mode, TriangleOrder)                                    \
  MODEBANK_EIGEN_TEMPLATE void                                                                \
  triangular_solve_matrix<double, Index, Side, Mode, false, TriangleOrder, ColMajor, 1>::run( \
      Index, Index, const double*, Index, double*, Index, Index, level3_blocking<double, double>&)
MODEBANK_EIGEN_SOLUTION(OnTheLeft, Lower, ColMajor);
MODEBANK_EIGEN_SOLUTION(OnTheLeft, Lower, RowMajor);
MODEBANK_EIGEN_SOLUTION(OnTheLeft, Upper, ColMajor);
MODEBANK_EIGEN_SOLUTION(OnTheLeft, Upper, RowMajor);
MODEBANK_EIGEN_SOLUTION(OnTheLeft, UnitLower, ColMajor);
MODEBANK_EIGEN_SOLUTION(OnTheLeft, UnitUpper, RowMajor);
MODEBANK_EIGEN_SOLUTION(OnTheRight, Upper, ColMajor);
MODEBANK_EIGEN_SOLUTION(OnTheRight, Upper, RowMajor);
#undef MODEBANK_EIGEN_SOLUTION

// NOLINTEND(bugprone-macro-parentheses)

}  // namespace internal

// Factorisations that ident/base/linalg.hpp does not instantiate. Eigen's constructors that take a matrix use these
// factorisations.
MODEBANK_EIGEN_TEMPLATE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
MODEBANK_EIGEN_TEMPLATE LLT<Ref<MatrixXd>>& LLT<Ref<MatrixXd>>::compute(const EigenBase<MatrixXd>&);
MODEBANK_EIGEN_TEMPLATE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
MODEBANK_EIGEN_TEMPLATE void PartialPivLU<MatrixXd>::compute();

}  // namespace Eigen
#endif
