#pragma once

// Another library of the robot that uses Eigen inside, compiled with its own options.

/// Makes, resizes and frees matrices.
double other_eigen_sum();
