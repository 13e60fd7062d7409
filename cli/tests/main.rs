//! The command line, as its users see it.

mod browser;
mod rig;
mod support;

mod alternative;
mod apply;
mod backlash;
mod bad_input;
mod bad_recordings;
mod commands;
mod control;
mod diagnose;
mod evaluate;
mod events;
mod exit_status;
mod experiment;
mod files;
mod film;
mod handout;
mod help;
mod identify;
mod imperfection;
mod language_server;
mod late;
mod law;
mod motion;
mod other_mechanisms;
mod picture;
mod planted;
mod recording;
mod reproduce;
mod simulate;
mod steady;
mod sticking;
mod walk_through;
mod watch;
