#pragma once

#include <string>
#include <vector>

namespace modebank::app::test {

/// Names that columns in users' files may have.
inline const std::vector<std::string>& hostile_names() {
  static const std::vector<std::string> names{"*/ int x; /*",
                                              "*$F/ int x; /$f*",
                                              "a\nb\r\n#error",
                                              "line \\",
                                              "?\?/",
                                              "\"; import os; os.system('x') #",
                                              "\"\"\"",
                                              "'''\\",
                                              "%{}{{}}%s$p$P$real",
                                              "=cmd|' /C calc'!A0",
                                              "+1",
                                              "-1",
                                              "@SUM(A1)",
                                              "\t=1",
                                              "\r=1",
                                              "a: b # c",
                                              "- &x *x !!python/object:os.system",
                                              "\xff\xfe\x00",
                                              "\xe2\x80\xa8line\xc2\x85",
                                              "while",
                                              "\\input{x} $ & % _ ^ ~",
                                              "yaw rate [\xc2\xb0/s]",
                                              "\x7f\x1b[31m",
                                              " "};
  return names;
}

}  // namespace modebank::app::test
