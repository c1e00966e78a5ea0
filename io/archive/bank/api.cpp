// The installed interface of the bank loader.
#include <memory>

#include "io/archive/bank/load_bank.hpp"
#include "modebank/archive/load_bank.hpp"
#include "modebank/base/error.hpp"

namespace modebank::archive {

filter::Bank load_bank(const std::string& path, const std::string& which) {
  try {
    return filter::Bank(std::make_shared<const modebank::Bank>(modebank::load_bank(path, which)));
  } catch (const ConfigurationError& error) {  // the installed interface throws DataError for a wrong path
    throw DataError(error.what());
  }
}

}  // namespace modebank::archive
