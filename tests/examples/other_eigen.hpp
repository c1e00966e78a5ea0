#pragma once

// Another library of the robot's that uses Eigen inside, compiled in its own way.

/// Makes, resizes and frees matrices.
double other_eigen_sum();
