# Completion of @PROGRAM@: commands and options are what its own --help names.
@FUNCTION@() {
  local word=${COMP_WORDS[COMP_CWORD]} command=()
  local i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} == [a-z]* ]] && command+=("${COMP_WORDS[i]}") || break
  done
  local help
  help=$(@PROGRAM@ "${command[@]}" --help 2>/dev/null)
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(grep -oE -- '--[a-z][a-z-]*' <<<"$help" | sort -u)" -- "$word")
  elif [ ${#command[@]} -eq 0 ]; then
    mapfile -t COMPREPLY < <(compgen -W "$(sed -nE 's/^  (@PROGRAM@ )?([a-z][a-z-]+) .*/\2/p' <<<"$help" | sort -u)" -- "$word")
  fi
  [ ${#COMPREPLY[@]} -gt 0 ] || mapfile -t COMPREPLY < <(compgen -f -- "$word")
}
complete -o filenames -F @FUNCTION@ @PROGRAM@
