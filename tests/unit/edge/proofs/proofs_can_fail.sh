#!/bin/sh
# proofs_can_fail.sh FOLDER NM OBJDUMP GUILTY_OBJECT INNOCENT_ARCHIVE: shows that each object proof
# finds violations, and reports a missing name.
folder=$1 nm=$2 objdump=$3 guilty=$4 innocent=$5
expect() {  # expect TEXT OUTPUT: the output of a failed proof names the culprit
  printf '%s\n' "$2" | grep -q -- "$1" && return
  echo "the proof did not find \"$1\" in:"
  printf '%s\n' "$2"
  exit 1
}
if found=$(sh "$folder/no_allocator.sh" "$nm" guilty_object "$guilty"); then
  echo "no_allocator.sh passed the guilty object"
  exit 1
fi
for symbol in malloc 'operator new' 'basic_string' __cxa_throw fprintf \
  '__throw_bad_function_call'; do
  expect "$symbol" "$found"
done
if found=$(sh "$folder/no_float.sh" "$objdump" guilty_object "$guilty"); then
  echo "no_float.sh passed the guilty object"
  exit 1
fi
case $("$objdump" -f "$guilty") in
  *x86-64* | *x86_64*) for name in mulsd addss cvttsd2si comisd; do expect "$name" "$found"; done ;;
  *aarch64*) for name in fmul fadd fcvtzs fcmp; do expect "$name" "$found"; done ;;
  *) for name in vmul vadd vcvt vcmp; do expect "$name" "$found"; done ;;
esac
for proof in "no_allocator.sh $nm" "no_float.sh $objdump"; do
  set -- $proof
  if found=$(sh "$folder/$1" "$2" no_such_name "$innocent"); then
    echo "$1 passed a name that is not there"
    exit 1
  fi
  expect "was it renamed" "$found"
done
