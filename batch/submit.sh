#!/usr/bin/env bash
# Runs the cases of a sweep as a Slurm job array, and gathers the results when all tasks have ended, also if some failed.
#
#   batch/submit.sh FOLDER [--per-task N] [--at-once M] [--threads T] [OPTIONS OF SBATCH ...]
#
#   N  cases in each task (default 10): so many that a task takes at least some minutes
#   M  tasks that run at once at most (default 100)
#   T  threads of a process (default 1); for large dry areas, with --cpus-per-task=T
#
#   batch/submit.sh film_map --per-task 50 --time=00:30:00 --partition=short
#
# The same command again runs what is missing or failed; finished cases are left alone.
set -euo pipefail

fail() {
  echo "submit.sh: $*" >&2
  exit 1
}

number() { # number NAME VALUE
  [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || fail "found $1 ${2:-without a value}, expected a number above 0"
  echo "$2"
}

[ $# -gt 0 ] && [[ $1 != -* ]] || {
  sed -n '2,13s/^# \{0,1\}//p' "$0"
  exit 1
}
root=$(cd "$(dirname "$0")/.." && pwd)
[ -f "$1/index.csv" ] || fail "$1: has no index.csv: it is no sweep, or one that is not written to its end"
[ ! -d "$1/replacement.part" ] || fail "$1: holds a replacement that was interrupted: batch/sweep.py SWEEP.toml --replace completes it"
folder=$(cd "$1" && pwd)
shift
per_task=10 at_once=100 threads=1 options=()
while [ $# -gt 0 ]; do
  case $1 in
  --per-task) per_task=$(number "$1" "${2:-}") ;;
  --at-once) at_once=$(number "$1" "${2:-}") ;;
  --threads) threads=$(number "$1" "${2:-}") ;;
  *)
    options+=("$1")
    shift
    continue
    ;;
  esac
  shift 2
done
command -v sbatch > /dev/null || fail "there is no sbatch here: run the cases with batch/run.py"

cases=$(($(wc -l < "$folder/index.csv") - 1))
tasks=$(((cases + per_task - 1) / per_task))
largest=$(scontrol show config | sed -n 's/^MaxArraySize *= *//p')
if [ "$tasks" -ge "${largest:-1001}" ]; then
  fail "found $tasks tasks, expected fewer than ${largest:-1001}: give at least --per-task $((cases / (${largest:-1001} - 1) + 1))"
fi
mkdir -p "$folder/log"
array=$(sbatch --parsable --array="1-$tasks%$at_once" --output="$folder/log/task_%a.log" "${options[@]}" \
  "$root/batch/array.sbatch" "$root" "$folder" "$per_task" "$threads")
array=${array%%;*}
gather=$(sbatch --parsable --dependency="afterany:$array" --output="$folder/log/gather.log" "$root/batch/gather.sbatch" \
  "$root" "$folder")
echo "array $array: $cases cases in $tasks tasks; gather ${gather%%;*} follows, into $folder/gathered.h5"
