# What the guest scripts share: checks that say PASS or FAIL, and vivid, Linux's virtual camera.
# $HEARTSERVO is the program, $VM this folder's parent, $CHECK recording_check, $MADE what the host made for the run.

export LC_ALL=C
BUILT=$(dirname "$HEARTSERVO")/tests/vm
MADE=$BUILT/made/$(basename "$0" .sh)
cd /tmp
mkfifo server.fifo
"$BUILT/fork_server" server.fifo &
HEARTSERVO=$VM/guest/heartservo CHECK=$VM/guest/recording_check
timeout 120 "$HEARTSERVO" --version || echo "FAIL the program does not start"

# check NAME SECONDS COMMAND...: it must end with 0 in time
check() {
  local name=$1 limit=$2 code
  shift 2
  timeout --kill-after=60 "$limit" "$@" >/tmp/out 2>/tmp/err
  code=$?
  if [ $code -eq 0 ]; then echo "PASS $name: $(tail -n 1 /tmp/out | cut -c1-160)"; else
    echo "FAIL $name: ended with $code: $(cat /tmp/out /tmp/err | tail -n 4 | tr '\n' ' ' | cut -c1-600)"
  fi
  return $code
}

# refused NAME CODE TEXT COMMAND...: it must end with CODE and one line on stderr that holds TEXT
refused() {
  local name=$1 wanted=$2 text=$3 code
  shift 3
  timeout --kill-after=60 90 "$@" >/tmp/out 2>/tmp/err
  code=$?
  if [ $code -eq "$wanted" ] && [ "$(wc -l </tmp/err)" -eq 1 ] && grep -qF -e "$text" /tmp/err; then
    echo "PASS $name: $(cut -c1-200 /tmp/err)"
  else
    echo "FAIL $name: ended with $code, not $wanted: $(tr '\n' ' ' </tmp/err | cut -c1-600)"
  fi
}

# says NAME FILE TEXT...: the file holds every text
says() {
  local name=$1 file=$2 text
  shift 2
  for text in "$@"; do
    if ! grep -qE -e "$text" "$file"; then
      echo "FAIL $name: no '$text' in $file: $(grep -A25 event_counts "$file" 2>/dev/null | tr -d '\n ' | cut -c1-700)"
      return 1
    fi
  done
  echo "PASS $name"
}

# vivid OPTION...: a fresh one; its faults leak into the next run otherwise
vivid() {
  modprobe -r vivid 2>/dev/null
  modprobe vivid n_devs=1 "$@" || { echo "FAIL vivid: cannot be loaded"; return 1; }
  for _ in $(seq 50); do [ -e /dev/video0 ] && return 0; sleep 0.1; done
  echo "FAIL vivid: no /dev/video0"
}

control() { timeout 10 v4l2-ctl -d /dev/video0 -c "$1" || echo "FAIL control $1"; }

# until_there FILE SECONDS
until_there() {
  for _ in $(seq $(($2 * 10))); do [ -e "$1" ] && return 0; sleep 0.1; done
  return 1
}
