#!/bin/sh
# Measures one unit and compares its result with limits, as a step of a CI job:
#
#   measure.sh PROCEDURE SERIAL PART LIMITS.TOML REPORT.XML [OPTION OF `jointbench run` …]
#
# With JOINTBENCH_URL the run starts as soon as the bench of that daemon is free. Without it, a daemon with the bench
# description JOINTBENCH_BENCH (default: the mock bench in this folder) runs for the time of the job.
# Exit code: 0 all limits met, 1 failed or a limit exceeded, 2 bad arguments, 3 undecided.
set -eu

if [ $# -lt 5 ]; then
    echo "usage: measure.sh PROCEDURE SERIAL PART LIMITS.TOML REPORT.XML [OPTION …]" >&2
    exit 2
fi
procedure=$1 serial=$2 part=$3 limits=$4 report=$5
shift 5
program=${JOINTBENCH_PROGRAM:-jointbench}
set -- run "$procedure" --unit "$serial" --part "$part" --limits "$limits" --junit "$report" \
    --queue --lease "${JOINTBENCH_LEASE_S:-60}" "$@"

if [ -n "${JOINTBENCH_URL:-}" ]; then
    exec "$program" "$@"
fi

# CI systems set a variable without a value to the empty text, which is not a token.
[ -n "${JOINTBENCH_TOKEN:-}" ] || unset JOINTBENCH_TOKEN
data=$(mktemp -d)
daemon=
: >"$data/address"
finish() {
    [ -z "$daemon" ] || { kill "$daemon" && wait "$daemon"; } 2>/dev/null || true
    rm -rf "$data"
}
trap finish EXIT
trap 'exit 1' INT TERM
"$program" serve --config "${JOINTBENCH_BENCH:-$(dirname "$0")/mock.toml}" --listen 127.0.0.1:0 --data "$data" \
    >"$data/address" 2>"$data/log" &
daemon=$!
until JOINTBENCH_URL=$(grep -o 'http://[^ ]*' "$data/address"); do
    kill -0 "$daemon" 2>/dev/null || { cat "$data/log" >&2; exit 1; }
    sleep 1
done
export JOINTBENCH_URL
"$program" "$@"
