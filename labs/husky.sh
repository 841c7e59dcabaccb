#!/usr/bin/env bash
# The first lab, line by line: a Husky in the simulator, driven and inspected from a shell.
#
# Prints each command as one would type it and what came back, and ends with what it checked.
# Exit code 0 when all of it holds. It runs on a bus of its own (a domain), so that it disturbs
# nobody; LCMTOOLS_DOMAIN=N chooses which.
set -u

unset LCM_DEFAULT_URL LCMTOOLS_NAMESPACE
export LCMTOOLS_DOMAIN=${LCMTOOLS_DOMAIN:-$((RANDOM % 100 + 100))}
logs=$(mktemp -d)
checks=()
failed=0

# --- telling ---------------------------------------------------------------------------------

if [ -t 1 ] && [ -z "${NO_COLOR:-}" ]; then bold=$'\e[1m' plain=$'\e[0m'; else bold='' plain=''; fi

typed() { # the command as one would type it: words with blanks in quotes
    local word text=''
    for word in "$@"; do
        case $word in
            *[\ \{\}\[\]\'\"]*) text+=" \"$word\"" ;;
            *) text+=" $word" ;;
        esac
    done
    printf '\n%s$%s%s\n' "$bold" "$text" "$plain"
}

chapter() { printf '\n%s== %s ==%s\n' "$bold" "$1" "$plain"; }

# --- running ---------------------------------------------------------------------------------

show() { # run a command in the foreground; its exit code is $code
    typed "$@"
    "$@"
    code=$?
}

begin() { # run a command in the background under a short name, as in a second terminal
    local name=$1
    shift
    typed "$@"
    "$@" > "$logs/$name" 2>&1 &
    printf -v "pid_$name" '%s' $!
}

end() { # press Ctrl-C in the terminal of that name
    local pid="pid_$1"
    kill -INT "${!pid}" 2> /dev/null
    wait "${!pid}" 2> /dev/null
}

within() { # within SECONDS COMMAND...: repeat a command until it succeeds
    local deadline=$((SECONDS + $1))
    shift
    until "$@" > /dev/null 2>&1; do
        [ "$SECONDS" -lt "$deadline" ] || return 1
        sleep 0.2
    done
}

leave() {
    trap - EXIT INT TERM
    local jobs_left
    jobs_left=$(jobs -p)
    # shellcheck disable=SC2086 # one word a process
    [ -z "$jobs_left" ] || kill $jobs_left 2> /dev/null
    wait
    rm -rf "$logs"
    exit "${1:-1}"
}
trap 'leave 1' EXIT
trap 'leave 130' INT
trap 'leave 143' TERM

# --- checking --------------------------------------------------------------------------------

check() { # check TEXT COMMAND...
    local text=$1 verdict='ok    '
    shift
    if ! "$@"; then
        verdict='FAILED'
        failed=1
    fi
    checks+=("$verdict  $text")
}

number() { # number TOPIC FIELD...: one number out of the next message of a topic
    local topic=$1
    shift
    lcmtools echo --json -n 1 --timeout 5s "$topic" |
        python3 -c 'import functools, json, sys
print(functools.reduce(lambda part, name: part[name], sys.argv[1:], json.load(sys.stdin)))' "$@"
}

speed() { number /husky0/odometry twist twist linear x; }
turn() { number /husky0/odometry twist twist angular z; }

near() { # near VALUE TARGET TOLERANCE
    awk -v v="$1" -v t="$2" -v e="$3" 'BEGIN { exit !(v != "" && v >= t - e && v <= t + e) }'
}

drives_at() { near "$(speed)" "$1" "$2"; }
turns_at() { near "$(turn)" "$1" "$2"; }
has_node() { lcmtools node list 2> /dev/null | grep -qx "$1"; }
says() { grep -qF -- "$1" "$logs/wtf"; }
diagnose() { # lcmtools wtf, its output kept for "says" and its exit code in $code
    typed lcmtools wtf
    lcmtools wtf > "$logs/wtf"
    code=$?
    cat "$logs/wtf"
}

# --- the lab ---------------------------------------------------------------------------------

chapter 'The simulator, and what is on the bus'
begin sim lcmtools run sim
if ! within 20 has_node /morse; then
    echo 'the simulator did not start:' >&2
    cat "$logs/sim" >&2
    leave 1
fi
show lcmtools list
show lcmtools info /husky0/odometry
check 'info names the type and the publisher of /husky0/odometry' \
    bash -c 'lcmtools info /husky0/odometry | grep -q nav_msgs/Odometry &&
             lcmtools info /husky0/odometry | grep -q "/morse"'
show lcmtools echo -n 1 /husky0/odometry
check 'the Husky stands still' drives_at 0 0.001

chapter 'Full power on both sides'
begin pub lcmtools pub /husky0/wheel_cmd sensor_msgs/JointState "name: ['left', 'right']
effort: [1, 1]"
within 4 drives_at 1.0 0.02
check 'effort [1, 1] drives at 1.000 m/s (2 %)' drives_at 1.0 0.02
show lcmtools echo -n 1 /husky0/wheel_velocities
end pub
show lcmtools pub -1 /husky0/wheel_cmd sensor_msgs/JointState "{name: [left, right], effort: [0, 0]}"
within 4 drives_at 0 0.01
check 'effort [0, 0] stops' drives_at 0 0.01

chapter 'A controller that is not connected'
begin controller lcmtools run simple_controller
within 5 has_node /simple_controller
diagnose
check 'wtf warns (exit code 1)' test "$code" -eq 1
check 'wtf names /odometry and /desired_velocity of /simple_controller' \
    eval 'says " * /simple_controller:" && says "   * /odometry" && says "   * /desired_velocity"'
show lcmtools node list
show lcmtools node info simple_controller
end controller

chapter 'A namespace connects its input'
begin controller lcmtools run simple_controller __ns:=/husky0
within 5 has_node /husky0/simple_controller
diagnose
check 'odometry is connected, velocity_cmd is not' \
    eval '! says "   * /husky0/odometry" && says "   * /husky0/velocity_cmd"'
end controller

chapter 'A remap connects its output'
begin controller lcmtools run simple_controller __ns:=/husky0 controlled_velocity:=velocity_cmd
within 5 has_node /husky0/simple_controller
diagnose
check 'velocity_cmd is connected too' eval '! says "   * /husky0/velocity_cmd"'
begin pub lcmtools pub /husky0/desired_velocity geometry_msgs/Twist \
    "{ linear: [0.1, 0, 0], angular: [0.0, 0, 0.1] }"
begin evaluate lcmtools run evaluate_controller __ns:=/husky0
within 5 has_node /husky0/evaluate_controller
within 6 drives_at 0.1 0.005
within 6 turns_at 0.1 0.01
check 'the controller reaches 0.1 m/s (5 %)' drives_at 0.1 0.005
check 'the controller reaches 0.1 rad/s (10 %)' turns_at 0.1 0.01
show lcmtools echo -n 2 /husky0/evaluation_stat
check 'the last error is below 0.02' near "$(number /husky0/evaluation_stat last_error)" 0 0.02
diagnose
check 'wtf finds no errors or warnings (exit code 0)' test "$code" -eq 0

chapter 'The end'
for name in evaluate pub controller; do end "$name"; done
end sim
check 'the simulator says goodbye: no node is left' eval '[ -z "$(lcmtools node list 2> /dev/null)" ]'

chapter 'What was checked'
printf '%s\n' "${checks[@]}"
leave "$failed"
