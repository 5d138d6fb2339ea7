//! Blocks of any width hold each UAV once, and touch no other.

use std::vec::Vec;

use super::*;
use crate::lanes::{gather_bits, spread};

#[test]
fn a_fleet_of_any_size_is_read_and_written_whole() {
    fn at<const W: usize>(uavs: usize) {
        let row: Vec<u64> = (1..=uavs as u64).collect();
        let mut copy = std::vec![0; uavs];
        let mut visited = 0;
        for block in blocks::<W>(uavs) {
            assert_eq!(block.first, visited);
            visited += block.count;
            let lanes = block.load(&row);
            let own = block.lanes().map(|lane| lanes[lane]);
            assert!(own.eq(row[block.first..][..block.count].iter().copied()));
            assert_eq!(
                block.in_order(&lanes).concat(),
                row[block.first..][..block.count]
            );
            let mask: Lanes<u64, W> = spread(block.mask());
            let counted = (0..W).filter(|&lane| mask[lane] != 0);
            assert!(counted.eq(block.lanes()));
            for (lane, &index) in block.indices().iter().enumerate() {
                let copy = row.get(block.first + index as usize).copied();
                assert!(block.count < Block::<W>::HALF || copy == Some(lanes[lane]));
            }
            block.store(&lanes, &mut copy);
        }
        assert_eq!((visited, copy), (uavs, row));
    }
    for uavs in 1..=70 {
        at::<1>(uavs);
        at::<2>(uavs);
        at::<16>(uavs);
    }
}

#[test]
fn words_of_rows_are_those_of_each_uav() {
    fn at<const W: usize>(uavs: usize, len: usize) {
        let rows: Vec<u64> = (0..(uavs * len) as u64).collect();
        let mut copy = std::vec![0; uavs * len];
        for block in blocks::<W>(uavs) {
            for word in 0..len {
                let lanes = block.load_word(&rows, len, word);
                for (index, lane) in block.lanes().enumerate() {
                    assert_eq!(lanes[lane], rows[(block.first + index) * len + word]);
                }
                block.store_word(&lanes, &mut copy, len, word);
            }
        }
        assert_eq!(copy, rows);
    }
    for (uavs, len) in [(7, 1), (15, 1), (15, 3), (37, 2)] {
        at::<1>(uavs, len);
        at::<2>(uavs, len);
        at::<16>(uavs, len);
    }
}

#[test]
fn bits_of_a_block_leave_the_others_alone() {
    fn at<const W: usize>() {
        let mut set = [0x0123_4567_89AB_CDEF, 0xFEDC_BA98_7654_3210];
        for block in blocks::<W>(100) {
            let before = set;
            let bits = block.bits(&set);
            assert_eq!(gather_bits(&spread::<W>(bits)), bits);
            assert_eq!(
                block.uavs_in(bits),
                before[block.first / 64] >> (block.first % 64) & (u64::MAX >> (64 - block.count))
            );
            block.put_bits(!bits, &mut set);
            assert_eq!(block.bits(&set), !bits & block.mask());
            block.put_bits(bits, &mut set);
            assert_eq!(set, before);
        }
    }
    at::<1>();
    at::<2>();
    at::<16>();
}
