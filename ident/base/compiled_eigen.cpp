#define MODEBANK_EIGEN_TEMPLATE template
#include "ident/base/compiled_eigen.hpp"
