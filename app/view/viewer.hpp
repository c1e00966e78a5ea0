#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "app/view/catalogue.hpp"
#include "app/view/jobs.hpp"
#include "app/view/message.hpp"

namespace modebank::app::view {

/// What the addresses of the server stand for; whoever asks has passed the gate.
///   /                       the overview, or the one archive's page
///   /overview.json          its rows (/overview.json?VERSION: none where nothing has changed)
///   /page.css /overview.js  what it consists of
///   /archive/ID             an archive's page
///   /compare/ID/ID          that of two
/// Nothing in an address is ever part of a file's name.
class Viewer {
 public:
  using Reply = std::function<void(Answer)>;

  /// `folder` is the server's own, for what children write.
  Viewer(const std::filesystem::path& what, const std::filesystem::path& folder);

  /// Replies at once or when a page is made; returns the number that gives the page up, 0 for none.
  std::uint64_t answer(const Request& request, const Reply& reply);
  void give_up(std::uint64_t page) { pages_.cancel(page); }

  /// To be called when a child may have ended, and often while busy().
  void tend();
  bool busy() const { return !pages_.idle() || !digests_.idle(); }

 private:
  std::uint64_t make_page(const std::vector<std::string>& ids, bool head, const Reply& reply);
  void read_digests();
  void read_digest(const std::string& id, Entry& entry);
  std::string overview_json(const std::string& seen);

  Catalogue catalogue_;
  Jobs pages_, digests_;
};

}  // namespace modebank::app::view
