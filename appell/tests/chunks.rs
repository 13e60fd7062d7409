//! Chunks of ensembles: what is in a folder already, whole, damaged, of another size or of more cases.

use appell::ensemble::{Ensemble, Folder, Memory, Running, Store, Watch};
use appell::json;

use crate::ensemble::{STUDY, Scratch, filled};

fn statistics(ensemble: &Ensemble, store: &dyn Store) -> serde_json::Value {
    let summary = ensemble.summary(store).unwrap();
    json::ensemble(ensemble.columns(), &summary)
}

fn watch() -> Watch<'static> {
    Watch {
        go_on: &|| true,
        done: &|_| {},
    }
}

#[test]
fn fewer_cases_in_a_folder_that_has_more_have_their_own_statistics() {
    let scratch = Scratch::new("fewer");
    let of = |cases: &str| scratch.ensemble(&STUDY.replace("4000", cases));
    let (many, few) = (of("200"), of("64"));
    let (both, alone) = (Memory::default(), Memory::default());
    filled(&many, &both, Running::default());
    filled(&few, &alone, Running::default());
    assert!(
        few.missing(&both, Running::default())
            .unwrap()
            .chunks
            .is_empty()
    );
    assert_eq!(few.summary(&both).unwrap().done, 64);
    assert_eq!(statistics(&few, &both), statistics(&few, &alone));
    // A chunk of both that ends beyond the fewer cases.
    let (ends_later, running) = (of("72"), Running::default());
    let alone = Memory::default();
    filled(&ends_later, &alone, running);
    assert_eq!(
        statistics(&ends_later, &both),
        statistics(&ends_later, &alone)
    );
    let mut rows = 0;
    ends_later.scan(&both, |some| rows += some.len()).unwrap();
    assert_eq!(rows, 72);
}

/// Every bit of a chunk counts: none is believed after it was changed, and the chunk is computed again.
#[test]
fn a_chunk_with_a_changed_bit_is_computed_again() {
    let scratch = Scratch::new("bits");
    let ensemble = scratch.ensemble(&STUDY.replace("4000", "48"));
    let (store, running) = (Memory::default(), Running::default());
    filled(&ensemble, &store, running);
    let wanted = statistics(&ensemble, &store);
    let name = store.names().unwrap()[1].clone();
    let whole = store.read(&name).unwrap();
    for flip in 0..150 {
        // Spread over all bytes.
        let byte = flip * whole.len() / 150;
        let mut changed = whole.to_vec();
        changed[byte] ^= 1 << (flip % 8);
        store.write(&name, changed).unwrap();
        assert!(ensemble.summary(&store).is_err(), "byte {byte}");
        let missing = ensemble.missing(&store, running).unwrap();
        assert_eq!(missing.damaged, [name.as_str()], "byte {byte}");
        assert_eq!(missing.chunks.len(), 1);
    }
    let missing = ensemble.missing(&store, running).unwrap();
    ensemble
        .fill(&store, &missing.chunks, running, watch())
        .unwrap();
    assert_eq!(store.read(&name).unwrap(), whole);
    assert_eq!(statistics(&ensemble, &store), wanted);
}

#[test]
fn exchanged_cut_and_foreign_chunks_are_not_believed() {
    let scratch = Scratch::new("exchanged");
    let ensemble = scratch.ensemble(&STUDY.replace("4000", "48"));
    let other = scratch.ensemble(&STUDY.replace("4000", "48\nseed = 2"));
    let (store, foreign) = (Memory::default(), Memory::default());
    let running = Running::default();
    filled(&ensemble, &store, running);
    filled(&other, &foreign, running);
    let names = store.names().unwrap();
    let [first, second] = [0, 1].map(|chunk| store.read(&names[chunk]).unwrap().to_vec());
    let theirs = foreign.read(&foreign.names().unwrap()[1]).unwrap().to_vec();
    for wrong in [
        first.clone(),
        theirs,
        second[..second.len() / 2].to_vec(),
        Vec::new(),
    ] {
        store.write(&names[1], wrong).unwrap();
        let missing = ensemble.missing(&store, running).unwrap();
        assert_eq!((missing.damaged.len(), missing.chunks.len()), (1, 1));
        assert!(ensemble.summary(&store).is_err());
    }
    // A damaged chunk of another size does no harm where others have its cases.
    store.write(&names[1], second).unwrap();
    let large = Running {
        chunk: Some(48),
        ..running
    };
    let name = ensemble.chunks(large.chunk).unwrap().chunk(0).name;
    store.write(&name, first).unwrap();
    assert_eq!(ensemble.summary(&store).unwrap().done, 48);
    assert_eq!(ensemble.missing(&store, large).unwrap().damaged, [name]);
}

/// Two of three of such runs ended with the drafts of others removed under their hands.
#[test]
fn equal_ensembles_run_in_one_folder_at_once() {
    let scratch = Scratch::new("at-once");
    let ensemble = scratch.ensemble(&STUDY.replace("4000", "320"));
    let alone = Memory::default();
    filled(&ensemble, &alone, Running::default());
    let wanted = statistics(&ensemble, &alone);
    let one = || {
        let store = Folder::new(&scratch.0.join("out")).unwrap();
        let running = Running {
            jobs: Some(2),
            ..Running::default()
        };
        // Each runs all chunks, as if it had seen none.
        let chunks = ensemble.chunks(None).unwrap();
        let all: Vec<_> = (0..chunks.count()).map(|n| chunks.chunk(n)).collect();
        for _ in 0..3 {
            ensemble.fill(&store, &all, running, watch()).unwrap();
            store.tidy().unwrap();
            assert_eq!(statistics(&ensemble, &store), wanted);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(one);
        }
    });
    let left = std::fs::read_dir(scratch.0.join("out")).unwrap();
    assert_eq!(left.count() as u64, ensemble.chunks(None).unwrap().count());
}
