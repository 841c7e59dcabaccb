# Shared by the labs' scripts: a bus of their own, commands printed as typed, checks, and an end
# that leaves nothing behind. Read by labs/*/lab.sh, not run.
#
# LCMTOOLS_DOMAIN=N chooses the bus, so that another terminal can watch.
# shellcheck shell=bash
set -u

free_domain() { # a domain whose port nobody has
    python3 -c 'import random, socket
for domain in random.sample(range(100, 232), 132):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("", 7667 + domain))
        except OSError:
            continue
    print(domain)
    break'
}

unset LCM_DEFAULT_URL LCMTOOLS_NAMESPACE
LCMTOOLS_DOMAIN=${LCMTOOLS_DOMAIN:-$(free_domain)}
export LCMTOOLS_DOMAIN
work=$(mktemp -d)    # scratch: what programs print, what the lab makes
logs=$work/logs
mkdir "$logs"
cd "$work" || exit 1
export XDG_STATE_HOME=$work/state XDG_CONFIG_HOME=$work/config # the person's own are left alone
checks=()
failed=0
code=0

# --- printing --------------------------------------------------------------------------------

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

show() { # run a command in the foreground; its exit code is $code, its output in $logs/shown
    typed "$@"
    timeout 60 "$@" > "$logs/shown" 2> "$logs/complaints"
    code=$?
    cat "$logs/shown" "$logs/complaints"
}

begin() { # run a command in the background under a short name, as in a second terminal
    local name=$1
    shift
    typed "$@"
    "$@" > "$logs/$name" 2>&1 < /dev/null &
    printf -v "pid_$name" '%s' $!
}

press() { # press NAME "KEYS" COMMAND...: the same with keys from a pipe, until they are over
    local name=$1 keys=$2
    shift 2
    printf '\n%s$ echo "%s" |%s\n' "$bold" "$keys" "$plain$(typed "$@" | sed -n 's/^[^$]*\$//p')"
    echo "$keys" | timeout 60 "$@" > "$logs/$name" 2>&1
    code=$?
}

keyboard() { # keyboard NAME COMMAND...: begin one that is driven by keys, which "keys" presses
    local name=$1
    shift
    typed "$@"
    mkfifo "$work/keyboard"
    "$@" < "$work/keyboard" > "$logs/$name" 2>&1 &
    printf -v "pid_$name" '%s' $!
    exec 3> "$work/keyboard"
    rm "$work/keyboard"
}

keys() { # keys WORD...: press them, now
    printf 'keys: %s\n' "$*"
    echo "$*" >&3
}

no_more_keys() { # no_more_keys NAME: wait for the end of what "keyboard" has begun
    local pid="pid_$1"
    exec 3>&-
    wait "${!pid}"
    code=$?
    cat "$logs/$1"
}

end() { # press Ctrl-C in the terminal of that name
    local pid="pid_$1"
    kill -INT "${!pid}" 2> /dev/null
    wait "${!pid}" 2> /dev/null
    code=$?
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
    rm -rf "$work"
    exit "${1:-1}"
}
trap 'leave 1' EXIT
trap 'leave 130' INT
trap 'leave 143' TERM

finish() { # print what was checked, and leave with what came of it
    chapter 'What was checked'
    printf '%s\n' "${checks[@]}"
    leave "$failed"
}

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

comes() { # comes TOPIC CONDITION: a message that meets it, within 30 s
    lcmtools echo -n 1 --timeout 30s --filter "$2" "$1" > /dev/null
}

moving() { # moving TOPIC FORWARD TURN_RATE: an odometry of this velocity, to 0.02 m/s and 0.03 rad/s
    local twist=twist.twist
    comes "$1" "abs($twist.linear.x - $2) < 0.02 and abs($twist.angular.z - $3) < 0.03"
}

has_node() { lcmtools node list 2> /dev/null | grep -qx -- "$1"; }
shown() { grep -qF -- "$1" "$logs/shown"; } # in the output of the last "show"
said() { grep -qF -- "$2" "$logs/$1"; }     # said NAME TEXT: in what a "begin" has printed
no_nodes() { [ -z "$(lcmtools node list 2> /dev/null)" ]; }

started() { has_node "$1" || ! kill -0 "$pid_sim"; } # or is over

simulate() { # simulate NODE COMMAND...: begin a simulator, and wait until its node is there
    local node=$1
    shift
    begin sim "$@"
    within 60 started "$node"
    if ! has_node "$node"; then
        echo 'the simulator did not start:' >&2
        cat "$logs/sim" >&2
        leave 1
    fi
}
