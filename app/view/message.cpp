#include "app/view/message.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include "app/report/page/html_page.hpp"
#include "ident/base/printable.hpp"

namespace modebank::app::view {

OpenFile::OpenFile(int descriptor)
    : held_(new int(descriptor), [](const int* held) {
        ::close(*held);
        delete held;
      }) {}

Answer sentence(unsigned status, const std::string& text, bool home) {
  Answer answer;
  answer.status = status;
  answer.type = "text/html; charset=utf-8";
  if (home) answer.policy = "default-src 'none'; style-src 'self'";
  answer.body = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>modebank</title>\n<meta "
      "name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\">{}</head>\n<body><main><h1>modebank</h1>\n<p>{}</p>{}</main></body>"
      "</html>\n",
      home ? "<link rel=\"stylesheet\" href=\"/page.css\">" : "", report::escaped_html(printable(text)),
      home ? "\n<p><a href=\"/\">All archives</a></p>" : "");
  return answer;
}

}  // namespace modebank::app::view
