# The scripts in bash source this file. With --help or -h among its arguments, the script prints the comment at its beginning
# and ends.
for argument in "$@"; do
  if [[ $argument == --help || $argument == -h ]]; then
    sed -n '2,/^[^#]/s/^# \{0,1\}//p' "${BASH_SOURCE[0]%/*}/${0##*/}"
    exit 0
  fi
done
