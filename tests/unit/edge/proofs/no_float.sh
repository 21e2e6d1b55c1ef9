#!/bin/sh
# no_float.sh OBJDUMP "NAME..." FILE...: fails, naming object and instruction, if an object
# NAME.cpp.o in the archives or objects FILE contains floating-point arithmetic, comparison or
# conversion (x86 SSE, AVX and x87, aarch64, armhf). Moves and integer vector instructions are
# allowed. Fails as well if a NAME is in no FILE.
objdump=$1 names=$2
shift 2
status=0
code=$(for file in "$@"; do "$objdump" -d --no-show-raw-insn "$file"; done)

sse='v?(add|sub|mul|div|sqrt|max|min|rcp|rsqrt|cmp[a-z]*|u?comi|hadd|hsub|addsub|dp|round|rndscale|fn?m(add|sub)(add|sub)?[0-9]*)(ss|sd|ps|pd)'
sse="$sse|v?cvt[a-z0-9]+"
x87='f(i?(ld|add|sub|subr|mul|div|divr|com|comp|st|stp)|ild|addp|subp|subrp|mulp|divp|divrp|sqrt|abs|chs|u?comi?p?p?|sin|cos|scale|ptan|yl2x|2xm1)[lsqt]*'
aarch64='f(add|sub|mul|nmul|div|madd|msub|nmadd|nmsub|sqrt|abs|neg|cmp|cmpe|ccmp|max|min|maxnm|minnm|mla|mls|rint[a-z]|cvt[a-z]*)'
aarch64="$aarch64|[su]cvtf"
armhf='v(add|sub|mul|nmul|div|mla|mls|nmla|nmls|fma|fms|sqrt|abs|neg|cmp|cmpe|cvt[a-z]?)(eq|ne|cs|cc|mi|pl|ge|lt|gt|le)?\.[a-z0-9.]*f(16|32|64)[a-z0-9.]*'
for name in $names; do
  own=$(printf '%s\n' "$code" | awk -v name="$name.cpp.o" '
    /file format/ {
      inside = match($0, /[A-Za-z0-9_]+\.cpp\.o/) && substr($0, RSTART, RLENGTH) == name
      next
    }
    inside')
  if [ -z "$own" ]; then
    echo "$name.cpp.o is in none of the files: was it renamed?"
    status=1
    continue
  fi
  found=$(printf '%s\n' "$own" |
    grep -E "^ *[0-9a-f]+:[[:space:]]+($sse|$x87|$aarch64|$armhf)([[:space:]]|\$)" | head -n 10)
  if [ -n "$found" ]; then
    echo "$name.cpp.o holds floating-point instructions:"
    printf '%s\n' "$found"
    status=1
  fi
done
exit $status
