# Completion of `voxtouch` and its nodes for bash; zsh loads it too (_voxtouch next to it). Verbs,
# options and their choices come from --help; scenes, motions, devices and effects from files.

_voxtouch_folder() {  # the folder with scenes and devices that belongs to the program
  local program
  program=$(readlink -f "$(command -v "$1")" 2>/dev/null) || return
  printf '%s' "${program%/*}/../share/voxtouch"
}

_voxtouch_names() {  # names of the YAML files of a folder
  local file
  for file in "$1"/*.yaml; do
    [[ -e $file ]] && file=${file##*/} && printf '%s\n' "${file%.yaml}"
  done
}

_voxtouch_scene_file() {  # SCENE as a file: itself, or a shipped one's name
  if [[ -f $2 ]]; then printf '%s' "$2"; elif [[ -n $2 ]]; then printf '%s' \
    "$(_voxtouch_folder "$1")/scenes/$2.yaml"; fi
}

_voxtouch_motions() {  # keys directly below `motions:`
  [[ -f $1 ]] && sed -n '/^motions:/,/^[^ #]/s/^  \([A-Za-z0-9_.-]*\):.*/\1/p' "$1"
}

# Of the scene that a rendering of this machine runs: kinds, from the second of a kind on with their
# numbers.
_voxtouch_effects() {
  local process scene word next
  for process in /proc/[0-9]*/cmdline; do
    next=
    { [[ $(tr '\0' '\n' < "$process" | head -n 1) == *voxtouch_rendering ]] || continue
      while IFS= read -r -d '' word; do
        [[ $next == scene ]] && scene=$word
        next=; [[ $word == --scene ]] && next=scene
      done < "$process"; } 2>/dev/null
  done
  [[ -f ${scene-} ]] && sed -n '/^effects:/,/^[^ #-]/p' "$scene" |
    grep -oE '(^effects: *\[ *\{|^ *- *\{?|^ *\{|, *\{) *[a-z_]+:' |
    grep -oE '[a-z_]+:$' | tr -d : | awk '{ print $1 (n[$1]++ ? n[$1] : "") }'
}

_voxtouch_options() {  # words of --help that begin with --
  "$@" --help 2>/dev/null | grep -oE '^  (-[a-z],)?--[a-z][a-z-]*' | grep -oE -- '--[a-z-]+'
}

# The words in the braces, or between the bars, that --help has behind an option.
_voxtouch_choices() {
  local option=$1
  shift
  "$@" --help 2>/dev/null | sed \
    -nE "s/^  (-[a-z],)?$option [^ ]*\{([^}]*)\}.*/\2/p; s/^  $option ([a-z]+(\|[a-z]+)+) .*/\1/p" \
    | tr ',|' '\n\n'
}

_voxtouch() {
  local program=$1 current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} verb= \
    scene= word n
  COMPREPLY=()
  local -a call=("$program")
  if [[ ${program##*/} == voxtouch ]]; then
    if ((COMP_CWORD == 1)); then
      local verbs
      verbs=$("$program" --help 2>/dev/null | sed \
        -n '/^Subcommands:/,$s/^  \([a-z][a-z]*\) .*/\1/p')
      COMPREPLY=($(compgen -W "$verbs --help --version" -- "$current"))
      return
    fi
    verb=${COMP_WORDS[1]}
    call+=("$verb")
    for ((n = 2; n < COMP_CWORD; ++n)); do
      word=${COMP_WORDS[n]}
      [[ $word != -* && ${COMP_WORDS[n - 1]} != -* && -z $scene ]] && scene=$word
    done
  fi
  for ((n = 1; n < COMP_CWORD - 1; ++n)); do [[ ${COMP_WORDS[n]} == --scene ]] &&
    scene=${COMP_WORDS[n + 1]}; done
  local share choices=
  share=$(_voxtouch_folder "$program")
  case $before in
    --device)
      # A colon separates words in bash: the part before it is removed from the reply.
      choices="sim-phantom sim-lwr emulated-phantom emulated-lwr emulated-fr3 phantom lwr fr3"
      choices+=" $(_voxtouch_names "$share/devices" | sed 's/^/sim:/')"
      ;;
    :)
      COMPREPLY=($(compgen -W "$(_voxtouch_names "$share/devices")" -- "$current"))
      COMPREPLY+=($(compgen -f -- "$current"))
      return
      ;;
    --motion) choices=$(_voxtouch_motions "$(_voxtouch_scene_file "$program" "$scene")") ;;
    --scene) choices=$(_voxtouch_names "$share/scenes") ;;
    --interface) choices="host lo $(ls /sys/class/net 2>/dev/null)" ;;
    --hand) choices=$("${call[@]}" --help 2>/dev/null | sed -nE '/--hand/,/^  -/p' |
      grep -oE '(pen|arm)(-[a-z]+)?|fingertip|released|any_passive' | sort -u) ;;
    --*) choices=$(_voxtouch_choices "$before" "${call[@]}") ;;
  esac
  if [[ -n $choices ]]; then
    COMPREPLY=($(compgen -W "$choices" -- "$current"))
  elif [[ $current == : && ${COMP_WORDS[COMP_CWORD - 2]-} == --device ]]; then
    COMPREPLY=($(_voxtouch_names "$share/devices"))
  elif [[ $current == -* ]]; then
    COMPREPLY=($(compgen -W "$(_voxtouch_options "${call[@]}")" -- "$current"))
  else
    case $verb in
      up | try | plan | probe | accuracy | view) [[ -z $scene ]] &&
        COMPREPLY=($(compgen -W "$(_voxtouch_names "$share/scenes")" -- "$current")) ;;
      change) [[ -z $scene ]] && COMPREPLY=($(compgen -W "$(_voxtouch_effects)" -- "$current"))
        [[ -n $scene ]] && COMPREPLY=($(compgen -W "on off gain" -- "$current")) ;;
    esac
  fi
  return 0
}

# Files if nothing else fits. The nodes have options only.
complete -o default -F _voxtouch voxtouch voxtouch_device voxtouch_rendering voxtouch_coupling \
  voxtouch_logger voxtouch_validator
