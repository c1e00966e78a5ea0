#include "io/archive/load_averaged.hpp"

#include "io/archive/bank/load_bank.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "io/archive/layout_data.hpp"

namespace modebank {

AveragedColumns load_averaged(const OpenArchive& archive) {
  Recording recording;
  read_root(archive, [&](GroupReader& root) {
    root.optional_group("data", true, {}, [&](GroupReader& member) { layout::exchange_channels(member, recording); });
  });
  const auto positions = [](const std::vector<Channel>& channels) {
    std::vector<Index> averaged;
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (channels[i].averaged) averaged.push_back(static_cast<Index>(i));
    return averaged;
  };
  return {positions(recording.states), positions(recording.inputs)};
}

}  // namespace modebank
