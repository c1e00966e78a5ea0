# shellcheck shell=bash disable=SC2046 # for bash: commands, options, keys and their values, as `modebank help` lists them
_modebank() {
  local topic=${COMP_WORDS[1]} words
  if [[ $COMP_CWORD == 1 || $3 == help ]]; then
    words=$("$1" help | sed -nE 's/^  ([a-z]+) .*/\1/p')
  elif [[ $2 == -* ]]; then
    words=$("$1" help "$topic" $("$1" help "$topic" | sed -n 's/.*all of them: modebank help//p') | sed -nE 's/^  (-[^-]*)?(--[a-z0-9_.-]+).*/\2/p')
  elif [[ $3 == --* ]]; then
    [[ $3 == *.* ]] && topic=${3#--}
    words=$("$1" help "$topic" | sed -nE "s,.*$3 +(([a-z0-9_]+ \| )+[a-z0-9_]+)( [^|].*|\$),\1,p" | tr -d '|')
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$2")
} 2>/dev/null
complete -o default -F _modebank modebank
