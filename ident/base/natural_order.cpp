#include "ident/base/natural_order.hpp"

#include <algorithm>
#include <numeric>

namespace modebank {

bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      const std::size_t i_end = std::min(a.find_first_not_of("0123456789", i), a.size());
      const std::size_t j_end = std::min(b.find_first_not_of("0123456789", j), b.size());
      const std::size_t i_first = std::min(a.find_first_not_of('0', i), i_end),
                        j_first = std::min(b.find_first_not_of('0', j), j_end);
      if (i_end - i_first != j_end - j_first) return i_end - i_first < j_end - j_first;
      if (const int order = a.compare(i_first, i_end - i_first, b, j_first, j_end - j_first); order != 0)
        return order < 0;
      i = i_end, j = j_end;
    } else if (a[i] != b[j]) {
      return a[i] < b[j];
    } else {
      ++i, ++j;
    }
  }
  return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

std::vector<std::size_t> natural_order(const std::vector<std::string>& names) {
  std::vector<std::size_t> order(names.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return natural_less(names[i], names[j]); });
  return order;
}

}  // namespace modebank
