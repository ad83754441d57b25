//! Matrices, stored column by column.

use super::Lowering;
use crate::code::Words;
use crate::error::LowerError;
use crate::instruction::Op;

impl Lowering<'_, '_> {
    /// Sum of products.
    pub(super) fn sum_of_products(
        &mut self,
        pairs: impl Iterator<Item = (u32, u32)>,
    ) -> Result<u32, LowerError> {
        let mut sum = None;
        for (a, b) in pairs {
            sum = Some(match sum {
                None => self.two(Op::MulF, a, b)?,
                Some(sum) => self.three(Op::MulAddF, a, b, sum)?,
            });
        }
        sum.ok_or_else(|| self.invalid("a sum of nothing"))
    }

    pub(super) fn matrix_vector(
        &mut self,
        m: &Words,
        (columns, rows): (u32, u32),
        v: &Words,
    ) -> Result<Words, LowerError> {
        (0..rows)
            .map(|row| {
                self.sum_of_products(
                    (0..columns).map(|column| (m.at(column * rows + row), v.at(column))),
                )
            })
            .collect()
    }

    pub(super) fn vector_matrix(
        &mut self,
        v: &Words,
        m: &Words,
        (columns, rows): (u32, u32),
    ) -> Result<Words, LowerError> {
        (0..columns)
            .map(|column| {
                self.sum_of_products((0..rows).map(|row| (v.at(row), m.at(column * rows + row))))
            })
            .collect()
    }

    pub(super) fn matrix_matrix(
        &mut self,
        a: &Words,
        size: (u32, u32),
        b: &Words,
        columns: u32,
    ) -> Result<Words, LowerError> {
        let mut all = Vec::new();
        for column in 0..columns {
            let v = b.slice(column * size.0, size.0);
            all.extend(self.matrix_vector(a, size, &v)?.iter());
        }
        Ok(all.into_iter().collect())
    }

    pub(super) fn transpose(&self, m: &Words, (columns, rows): (u32, u32)) -> Words {
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| m.at(column * rows + row)))
            .collect()
    }

    pub(super) fn determinant(&mut self, m: &Words, size: u32) -> Result<u32, LowerError> {
        let all: Vec<u32> = (0..size).collect();
        self.minor(m, size, &all, &all)
    }

    /// Determinant of the given columns and rows.
    fn minor(
        &mut self,
        m: &Words,
        size: u32,
        columns: &[u32],
        rows: &[u32],
    ) -> Result<u32, LowerError> {
        let (Some((&column, columns)), Some(&row)) = (columns.split_first(), rows.first()) else {
            return self.float(1.0);
        };
        if columns.is_empty() {
            return Ok(m.at(column * size + row));
        }
        let mut sum = None;
        for (at, &row) in rows.iter().enumerate() {
            let rest: Vec<u32> = rows.iter().copied().filter(|&other| other != row).collect();
            let minor = self.minor(m, size, columns, &rest)?;
            let product = self.two(Op::MulF, m.at(column * size + row), minor)?;
            sum = Some(match sum {
                None => product,
                Some(sum) => {
                    self.two(if at % 2 == 0 { Op::AddF } else { Op::SubF }, sum, product)?
                }
            });
        }
        sum.ok_or_else(|| self.invalid("a determinant of nothing"))
    }

    /// Adjugate over determinant.
    pub(super) fn inverse(&mut self, m: &Words, size: u32) -> Result<Words, LowerError> {
        let determinant = self.determinant(m, size)?;
        let mut all = Vec::new();
        for column in 0..size {
            for row in 0..size {
                // The cofactor of the transposed place.
                let columns: Vec<u32> = (0..size).filter(|&other| other != row).collect();
                let rows: Vec<u32> = (0..size).filter(|&other| other != column).collect();
                let mut cofactor = self.minor(m, size, &columns, &rows)?;
                if (column + row) % 2 == 1 {
                    cofactor = self.one(Op::NegF, cofactor)?;
                }
                all.push(self.two(Op::DivF, cofactor, determinant)?);
            }
        }
        Ok(all.into_iter().collect())
    }
}
